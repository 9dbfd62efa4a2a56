//! The multiplier that allows the largest rate, by linear programming on a grid of frequencies.

use microlp::{ComparisonOp, OptimizationDirection, Problem, Variable};
use nalgebra::Complex;

use super::Moving;
use super::check::{Claim, Failure, Loop, Step};
use crate::sampled::polynomial::{Polynomial, on_circle};
use crate::sampled::window::angles;

/// Taps that may be other than 0.
const TAPS: [usize; 18] = [1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 48, 64, 85, 113, 150, 200, 270];

/// Lowest frequency of the grid \[rad/sample\].
const LOWEST: f64 = 1e-4;

/// Rates that are looked at \[1/s\], and how finely.
const RATES: (f64, f64) = (1e-2, 1e4);
const FINE: f64 = 1.02;

/// Share of the largest sizes that a programme has to leave between both sides.
const MARGIN: f64 = 1e-4;

/// The largest rate with its proof.
pub(super) fn largest(
    about: &Loop,
    (low, high): (f64, f64),
    period: f64,
) -> Result<Moving, Failure> {
    let grid = Grid::of(about, (low, high));
    let tried = |rate: f64| -> Option<Moving> {
        let (h, drift) = grid.multiplier(rate, period)?;
        let claim = Claim { low, high, period, rate, h: &h, drift };
        claim.check(about).ok()?;
        let delta = claim.step().delta;
        Some(Moving {
            low,
            high,
            rate_per_s: rate,
            delta,
            h: h.clone(),
            drift,
            needed_motion_per_s: None,
            needed_limits_per_s: None,
        })
    };
    let (mut below, mut above) = RATES;
    let mut best = tried(below).ok_or_else(|| Failure {
        inequality: "a multiplier exists for inertia that changes at 0.01 1/s".to_owned(),
        left: 0.0,
        right: 1.0,
    })?;
    while above / below > FINE {
        let middle = (below * above).sqrt();
        match tried(middle) {
            Some(found) => (best, below) = (found, middle),
            None => above = middle,
        }
    }
    Ok(best)
}

/// `N`, `Δ`, `K` at the frequencies of the grid.
struct Grid {
    range: (f64, f64),
    points: Vec<Point>,
}

struct Point {
    theta: f64,
    /// `|N + cΔ|²`.
    shifted: f64,
    /// `Im(NΔ*)`.
    turned: f64,
    open: f64,
    kick: f64,
    /// `|N|² + c²|Δ|²`.
    scale: f64,
    /// `|N| < 2 high |Δ|`: the loop is not large against the inertia.
    close: bool,
}

impl Grid {
    fn of(about: &Loop, (low, high): (f64, f64)) -> Self {
        let [n, d, k] =
            [&about.numerator, &about.denominator, &about.kick].map(|p| Polynomial::new(p.clone()));
        let c = 0.5 * (low + high);
        let point = |theta: f64| {
            let w = on_circle(theta, 1.0);
            let (n, d, k): (Complex<f64>, Complex<f64>, Complex<f64>) = (n.at(w), d.at(w), k.at(w));
            Point {
                theta,
                shifted: (n + d * c).norm_sqr(),
                turned: (n * d.conj()).im,
                open: d.norm_sqr(),
                kick: k.norm_sqr(),
                scale: n.norm_sqr() + c * c * d.norm_sqr(),
                close: n.norm() < 2.0 * high * d.norm(),
            }
        };
        let thetas = angles().into_iter().filter(|theta| *theta >= LOWEST);
        Self { range: (low, high), points: thetas.map(point).collect() }
    }

    /// `h` and `λ` for a rate; `None` where there are none.
    fn multiplier(&self, rate: f64, period: f64) -> Option<(Vec<f64>, f64)> {
        let (low, high) = self.range;
        let claim = Claim { low, high, period, rate, h: &[], drift: 1.0 };
        let step = claim.step();
        let close = self.points.iter().filter(|p| p.close);
        let kick = close.map(|p| (p.kick / p.open).sqrt()).fold(0.0, f64::max);
        let drift = (0.5 * (high - low) * kick / step.apart).max(1e-6);
        let first = self.programme(step, drift, &[])?;
        let h = self.programme(step, drift, &first)?;
        Some((h, drift))
    }

    /// Maximises the least room; `before` is an estimate of the taps, for the term in `y²`.
    fn programme(&self, step: Step, drift: f64, before: &[f64]) -> Option<Vec<f64>> {
        let (low, high) = self.range;
        let r = 0.5 * (high - low);
        let whole = r * r + drift * step.apart * step.apart;
        let known = Claim { low, high, period: 1.0, rate: 0.0, h: before, drift };
        let mut problem = Problem::new(OptimizationDirection::Maximize);
        let room = problem.add_var(1.0, (-1.0, 1.0));
        let most = 1e3 * high;
        let taps: Vec<(usize, Variable, Variable)> = TAPS
            .iter()
            .map(|j| (*j, problem.add_var(0.0, (0.0, most)), problem.add_var(0.0, (0.0, most))))
            .collect();
        for p in &self.points {
            let size = p.open + p.kick / drift;
            let y = known.multiplier(p.theta);
            let left = p.shifted - whole * size - p.kick * y * y / (4.0 * drift);
            let mut row = vec![(room, -1.0)];
            for (j, plus, minus) in &taps {
                let j = *j as f64;
                let gain = 2.0 * (j * p.theta).sin() * p.turned / p.scale;
                let cost = (step.delta * j).min(high - low) * size / p.scale;
                row.extend([(*plus, gain - cost), (*minus, -gain - cost)]);
            }
            problem.add_constraint(&row, ComparisonOp::Ge, -left / p.scale);
        }
        let solution = problem.solve().ok()?.into_solution().ok()?;
        if solution.var_value(room) < MARGIN {
            return None;
        }
        let mut h = vec![0.0; TAPS[TAPS.len() - 1]];
        for (j, plus, minus) in taps {
            h[j - 1] = solution.var_value(plus) - solution.var_value(minus);
        }
        let last = h.iter().rposition(|h| h.abs() > 0.0).map_or(0, |j| j + 1);
        h.truncate(last);
        Some(h)
    }
}
