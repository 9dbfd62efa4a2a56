//! The multiplier that allows the largest rate, one for all joints, by linear programming on a grid of frequencies.

use microlp::{ComparisonOp, OptimizationDirection, Problem, Variable};
use nalgebra::Complex;
use phihat_certificate::extremes::Extremes as _;
use phihat_certificate::{Moving, Unstable};

use super::cut::LoopCut;
use crate::portable;
use crate::sampled::polynomial::on_circle;
use crate::sampled::window::angles;

/// Taps that may be other than 0.
const TAPS: [usize; 18] = [1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 48, 64, 85, 113, 150, 200, 270];

/// Size of the loop over that of the inertia from which on no multiplier is needed.
const LARGE: f64 = 300.0;

/// Rates that are looked at \[1/s\], and how often the interval of their logarithm is halved.
const RATES: (f64, f64) = (1e-2, 1e4);
const HALVINGS: u32 = 10;

/// Share of the sizes on both sides that a programme leaves between them if it can, and has to.
const ROOM: f64 = 0.03;
const MARGIN: f64 = 1e-4;

/// Weight of the taps' size against that: large ones bend between the points of the grid.
const SMALL: f64 = 1e-5;

/// Number of times that the frequency at which a proof fails may join the grid.
const ROUNDS: u32 = 5;

/// With different laws, a programme begins with every so many points of the grid; those at which its answer
/// leaves less room than it assumes, by more than a share, join it, so often.
const SPARSE: usize = 8;
const THINKS: f64 = 1e-6;
const JOINS: u32 = 40;

/// The largest rate with its proof.
pub(super) fn largest(about: &[LoopCut<'_>], range: (f64, f64)) -> Result<Moving, Unstable> {
    let mut grid = ConditionGrid::of(about, range);
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
struct ConditionGrid {
    range: (f64, f64),
    /// One list for each loop.
    points: Vec<Vec<ConditionPoint>>,
}

struct ConditionPoint {
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
    /// It is in the programme.
    counts: bool,
}

impl ConditionPoint {
    fn at(theta: f64, about: &LoopCut<'_>, (low, high): (f64, f64)) -> Self {
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
            close: portable::size(n) < 2.0 * high * portable::size(d),
            matters: portable::size(n) < LARGE * high * portable::size(d),
            counts: true,
        }
    }
}

/// Condition (M2) on the taps at one point, over its scale: `Σ h_j gain_j − |h_j| cost_j − room ≥ least`.
struct ConditionRow {
    /// `gain_j`, `cost_j`, in the order of [`TAPS`].
    taps: Vec<(f64, f64)>,
    least: f64,
}

impl ConditionRow {
    fn new(p: &ConditionPoint, before: &Moving, eta: f64) -> Self {
        let Moving { low, high, delta, drift, .. } = *before;
        let r = 0.5 * (high - low);
        let size = p.open + p.kick / drift;
        let y = before.multiplier(p.theta);
        let whole = r * r + drift * eta * eta;
        let left = p.shifted - whole * size - p.kick * y * y / (4.0 * drift);
        let tap = |j: &usize| {
            let j = *j as f64;
            let gain = 2.0 * libm::sin(j * p.theta) * p.turned / p.scale;
            (gain, (delta * j).min(high - low) * size / p.scale)
        };
        Self { taps: TAPS.iter().map(tap).collect(), least: -left / p.scale }
    }

    fn room(&self, h: &[f64]) -> f64 {
        let taps = h.iter().zip(&self.taps);
        taps.map(|(h, (gain, cost))| h * gain - h.abs() * cost).sum::<f64>() - self.least
    }
}

impl ConditionGrid {
    fn of(about: &[LoopCut<'_>], range: (f64, f64)) -> Self {
        let own = |cut: &LoopCut<'_>| {
            let points = angles().into_iter().map(|theta| ConditionPoint::at(theta, cut, range));
            let mut points: Vec<ConditionPoint> = points.filter(|p| p.matters).collect();
            for (i, point) in points.iter_mut().enumerate() {
                point.counts = about.len() == 1 || i % SPARSE == 0;
            }
            points
        };
        Self { range, points: about.iter().map(own).collect() }
    }

    /// A multiplier for a rate, with its proof.
    fn proved(&mut self, about: &[LoopCut<'_>], rate: f64) -> Result<Moving, Unstable> {
        let mut failure = Unstable {
            inequality: format!("a multiplier exists for inertia that changes at {rate:.3} 1/s"),
            theta: 0.0,
            left: 0.0,
            right: 1.0,
        };
        let Some(period) = about.first().map(|cut| cut.model.period_s) else {
            return Err(failure);
        };
        for _ in 0..ROUNDS {
            let Some(moving) = self.multiplier(rate, period) else { break };
            let mut fails = false;
            for (cut, points) in about.iter().zip(&mut self.points) {
                if let Err(why) = moving.stable(cut.gains, cut.model) {
                    points.push(ConditionPoint::at(why.theta, cut, self.range));
                    (failure, fails) = (why, true);
                }
            }
            if !fails {
                return Ok(moving);
            }
        }
        Err(failure)
    }

    /// A multiplier for a rate, not yet proved; `None` where there is none.
    fn multiplier(&mut self, rate: f64, period: f64) -> Option<Moving> {
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
        let (delta, eta) = moving.step(period);
        let close = self.points.iter().flatten().filter(|p| p.close);
        let kick = close.map(|p| (p.kick / p.open).sqrt()).largest();
        moving.delta = delta;
        moving.drift = (0.5 * (high - low) * kick / eta).max(1e-6);
        // The second time with the first's estimate of the term in y².
        for _ in 0..2 {
            moving.h = self.taps(&moving, eta)?;
        }
        Some(moving)
    }

    /// Taps that leave the most room, up to what is enough, at every point of the grid.
    fn taps(&mut self, before: &Moving, eta: f64) -> Option<Vec<f64>> {
        let of = |points: &Vec<ConditionPoint>| {
            points.iter().map(|p| ConditionRow::new(p, before, eta)).collect()
        };
        let rows: Vec<Vec<ConditionRow>> = self.points.iter().map(of).collect();
        let mut taps = Vec::new();
        for _ in 0..JOINS {
            let both = self.points.iter().flatten().zip(rows.iter().flatten());
            let counted = both.filter(|(p, _)| p.counts).map(|(_, row)| row);
            let (found, room) = programme(counted, before.high)?;
            let mut more = false;
            for (points, rows) in self.points.iter_mut().zip(&rows) {
                more |= join(points, rows, &found, room);
            }
            taps = found;
            if !more {
                break;
            }
        }
        let mut h = vec![0.0; TAPS[TAPS.len() - 1]];
        for (j, tap) in TAPS.iter().zip(taps) {
            h[j - 1] = tap;
        }
        let last = h.iter().rposition(|h| h.abs() > 0.0).map_or(0, |j| j + 1);
        h.truncate(last);
        Some(h)
    }
}

/// Takes the points with the least room among their neighbours into the programme where that is less than it thinks.
fn join(points: &mut [ConditionPoint], rows: &[ConditionRow], taps: &[f64], thinks: f64) -> bool {
    let room: Vec<f64> = rows.iter().map(|row| row.room(taps)).collect();
    let mut more = false;
    for (i, point) in points.iter_mut().enumerate() {
        let beside = [i.checked_sub(1), Some(i + 1)].map(|k| k.and_then(|k| room.get(k)));
        let least = beside.into_iter().flatten().all(|other| room[i] <= *other);
        if !point.counts && least && room[i] < thinks - THINKS {
            (point.counts, more) = (true, true);
        }
    }
    more
}

/// Taps, in the order of [`TAPS`], and the room that they leave; `None` where that is not enough.
fn programme<'a>(
    rows: impl Iterator<Item = &'a ConditionRow>,
    high: f64,
) -> Option<(Vec<f64>, f64)> {
    let mut problem = Problem::new(OptimizationDirection::Maximize);
    let room = problem.add_var(1.0, (-1.0, ROOM));
    let mut tap = |j: &usize| problem.add_var(-SMALL * *j as f64 / high, (0.0, f64::INFINITY));
    let taps: Vec<(Variable, Variable)> = TAPS.iter().map(|j| (tap(j), tap(j))).collect();
    for own in rows {
        let mut row = vec![(room, -1.0)];
        for ((plus, minus), (gain, cost)) in taps.iter().zip(&own.taps) {
            row.extend([(*plus, gain - cost), (*minus, -gain - cost)]);
        }
        problem.add_constraint(&row, ComparisonOp::Ge, own.least);
    }
    let solution = problem.solve().ok()?.into_solution().ok()?;
    let left = solution.var_value(room);
    let value = |tap| solution.var_value(tap);
    let taps = taps.into_iter().map(|(plus, minus)| value(plus) - value(minus)).collect();
    (left >= MARGIN).then_some((taps, left))
}
