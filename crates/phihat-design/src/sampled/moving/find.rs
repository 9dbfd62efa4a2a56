//! The multiplier that allows the largest rate, by linear programming on a grid of frequencies.

use microlp::{ComparisonOp, OptimizationDirection, Problem, Variable};
use nalgebra::Complex;
use phihat_certificate::extremes::Extremes as _;
use phihat_certificate::{Moving, Unstable};

use super::cut::Cut;
use crate::sampled::polynomial::on_circle;
use crate::sampled::window::angles;

/// Taps that may be other than 0.
const TAPS: [usize; 18] = [1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 48, 64, 85, 113, 150, 200, 270];

/// Where the loop is so many times the inertia, no multiplier is needed.
const LARGE: f64 = 300.0;

/// Rates that are looked at \[1/s\], and how often the interval of their logarithm is halved.
const RATES: (f64, f64) = (1e-2, 1e4);
const HALVINGS: u32 = 10;

/// Share of the sizes on both sides that a programme leaves between them if it can, and has to.
const ROOM: f64 = 0.03;
const MARGIN: f64 = 1e-4;

/// What the taps' size counts against that: large ones bend between the points of the grid.
const SMALL: f64 = 1e-5;

/// How often the frequency at which a proof fails joins the grid.
const ROUNDS: u32 = 5;

/// The largest rate with its proof.
pub(super) fn largest(about: &Cut<'_>, range: (f64, f64)) -> Result<Moving, Unstable> {
    let mut grid = Grid::of(about, range);
    let (mut below, mut above) = RATES;
    let mut best = grid.proved(about, below)?;
    for _ in 0..HALVINGS {
        let middle = (below * above).sqrt();
        match grid.proved(about, middle) {
            Ok(found) => (best, below) = (found, middle),
            Err(_) => above = middle,
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
    matters: bool,
}

impl Point {
    fn at(theta: f64, about: &Cut<'_>, (low, high): (f64, f64)) -> Self {
        let w = on_circle(theta, 1.0);
        let [n, d, k]: [Complex<f64>; 3] =
            [&about.open.numerator, &about.open.denominator, &about.kick].map(|p| p.at(w));
        let c = 0.5 * (low + high);
        Self {
            theta,
            shifted: (n + d * c).norm_sqr(),
            turned: (n * d.conj()).im,
            open: d.norm_sqr(),
            kick: k.norm_sqr(),
            scale: n.norm_sqr() + c * c * d.norm_sqr(),
            close: n.norm() < 2.0 * high * d.norm(),
            matters: n.norm() < LARGE * high * d.norm(),
        }
    }
}

impl Grid {
    fn of(about: &Cut<'_>, range: (f64, f64)) -> Self {
        let points = angles().into_iter().map(|theta| Point::at(theta, about, range));
        Self { range, points: points.filter(|p| p.matters).collect() }
    }

    /// A multiplier for a rate, with its proof.
    fn proved(&mut self, about: &Cut<'_>, rate: f64) -> Result<Moving, Unstable> {
        let mut failure = Unstable {
            inequality: format!("a multiplier exists for inertia that changes at {rate:.3} 1/s"),
            theta: 0.0,
            left: 0.0,
            right: 1.0,
        };
        for _ in 0..ROUNDS {
            let Some(moving) = self.multiplier(rate, about.model.period_s) else { break };
            match moving.stable(about.gains, about.model) {
                Ok(()) => return Ok(moving),
                Err(why) => failure = why,
            }
            self.points.push(Point::at(failure.theta, about, self.range));
        }
        Err(failure)
    }

    /// A multiplier for a rate, not yet proved; `None` where there is none.
    fn multiplier(&self, rate: f64, period: f64) -> Option<Moving> {
        let (low, high) = self.range;
        let mut moving = Moving {
            low,
            high,
            rate_per_s: rate,
            delta: 0.0,
            h: Vec::new(),
            drift: 1.0,
            needed_motion_per_s: None,
            needed_limits_per_s: None,
        };
        let (delta, apart) = moving.step(period);
        let close = self.points.iter().filter(|p| p.close);
        let kick = close.map(|p| (p.kick / p.open).sqrt()).largest();
        moving.delta = delta;
        moving.drift = (0.5 * (high - low) * kick / apart).max(1e-6);
        // The second time with the first's estimate of the term in y².
        for _ in 0..2 {
            moving.h = self.programme(&moving, apart)?;
        }
        Some(moving)
    }

    /// Taps that leave the most room, up to what is enough.
    fn programme(&self, before: &Moving, apart: f64) -> Option<Vec<f64>> {
        let Moving { low, high, delta, drift, .. } = *before;
        let r = 0.5 * (high - low);
        let whole = r * r + drift * apart * apart;
        let mut problem = Problem::new(OptimizationDirection::Maximize);
        let room = problem.add_var(1.0, (-1.0, ROOM));
        let mut tap = |j: f64| problem.add_var(-SMALL * j / high, (0.0, f64::INFINITY));
        let taps: Vec<(usize, Variable, Variable)> =
            TAPS.iter().map(|j| (*j, tap(*j as f64), tap(*j as f64))).collect();
        for p in &self.points {
            let size = p.open + p.kick / drift;
            let y = before.multiplier(p.theta);
            let left = p.shifted - whole * size - p.kick * y * y / (4.0 * drift);
            let mut row = vec![(room, -1.0)];
            for (j, plus, minus) in &taps {
                let j = *j as f64;
                let gain = 2.0 * (j * p.theta).sin() * p.turned / p.scale;
                let cost = (delta * j).min(high - low) * size / p.scale;
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
