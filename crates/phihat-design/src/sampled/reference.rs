//! Error from the reference's own motion: the part of the error that no unknown torque causes.

use nalgebra::{DMatrix, DVector};
pub use phihat_certificate::ReferenceError;

use super::model::LoopModel;
use super::peak::mean_of_parabola;
use super::refutation::{plausible, plausible_loop, plausible_ratios, refuse};
use super::response::{Horizon, OutputRow, ratios, sweep};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "reference error";

/// An error that stays under a constant acceleration of 1 rad/s² is none below this \[rad/(rad/s²)\].
const NONE: f64 = 1e-12;

/// Finding a [`ReferenceError`].
pub trait FindReferenceError: Sized {
    /// Computes the gains from the reference's motion at `count` inertia ratios from `low` to `high`.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is unstable at one of them.
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        feed_forward: bool,
        range: (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation>;
}

/// Ratio of a claim to the computed result.
const ROUNDED_UP: f64 = 1.0 + 1e-6;

impl FindReferenceError for ReferenceError {
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        feed_forward: bool,
        (low, high): (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation> {
        over(gains, model, feed_forward, ratios(low, high, count).collect())
    }
}

fn over(
    gains: &JointRecord,
    model: &LoopModel,
    feed_forward: bool,
    mu: Vec<f64>,
) -> Result<ReferenceError, Refutation> {
    plausible(CLAIM, gains)?;
    plausible_loop(CLAIM, model)?;
    plausible_ratios(CLAIM, &mu)?;
    let (mut acceleration, mut jerk) = ([0.0_f64; 2], [Some(0.0_f64); 2]);
    for ratio in &mu {
        let matrix = StateMatrix::new(gains, model, *ratio);
        let unstable = || refuse(CLAIM, "A^k → 0 (stable loop), μ", *ratio, 1.0);
        if gains.observer.is_some() {
            let horizon = Horizon::of(matrix.matrix()).ok_or_else(unstable)?;
            let t = model.period_s;
            for of in 0..2 {
                let kick = kicked(&matrix, of, horizon) * t * t / ratio;
                acceleration[of] = acceleration[of].max(0.25 * kick);
                jerk[of] = jerk[of].map(|gain| gain.max(t * kick / 12.0));
            }
            continue;
        }
        let following = ReferenceFollowing::of(&matrix, feed_forward).ok_or_else(unstable)?;
        let horizon = Horizon::of(matrix.matrix()).ok_or_else(unstable)?;
        for of in 0..2 {
            acceleration[of] = acceleration[of].max(following.acceleration(of, horizon));
            jerk[of] = jerk[of].zip(following.jerk(of, horizon)).map(|(a, b)| a.max(b));
        }
    }
    // Sums are cut where their bound on the rest is small; another way to sum them has another rest.
    let [acceleration, velocity_acceleration] = acceleration.map(|gain| gain * ROUNDED_UP);
    let [jerk, velocity_jerk] = jerk.map(|gain| gain.map(|gain| gain * ROUNDED_UP));
    Ok(ReferenceError {
        feed_forward,
        mu,
        acceleration,
        jerk,
        velocity_acceleration,
        velocity_jerk,
    })
}

/// `Σ_j |c A^j e_0|` to the entry of `e` (0) or of `ė` (1): what a kick of 1 rad in position costs.
fn kicked(matrix: &StateMatrix, entry: usize, horizon: Horizon) -> f64 {
    let a = matrix.matrix();
    let mut row = DVector::zeros(a.nrows());
    row[entry] = if entry == 0 { 1.0 } else { matrix.unit() };
    let mut total = 0.0;
    let rows = sweep(a, &row, horizon, |row, _| total += row[0].abs());
    total + horizon.tail(rows, 1.0)
}

/// State that a unit of acceleration held over one interval leaves, for a search; `None` if the loop does not
/// follow.
pub(crate) fn left_by_acceleration(matrix: &StateMatrix) -> Option<DVector<f64>> {
    ReferenceFollowing::of(matrix, true).map(|following| following.leaves())
}

/// The state that follows a reference: columns for `q_d`, `q̇_d`, `q̈_d`.
struct ReferenceFollowing<'a> {
    a: &'a DMatrix<f64>,
    period: f64,
    /// `(μ − 1)/μ`, and what one unit of velocity is: the inertia's share that `φ` bears.
    borne: (f64, f64),
    /// `R` of `q̈_d`.
    forward: DVector<f64>,
    s: [DVector<f64>; 3],
}

impl<'a> ReferenceFollowing<'a> {
    fn of(matrix: &'a StateMatrix, feed_forward: bool) -> Option<Self> {
        let (a, t) = (matrix.matrix(), matrix.period());
        let n = a.nrows();
        let back = (DMatrix::identity(n, n) - a).lu();
        let [position, velocity, acceleration] = matrix.reference();
        let fed = if feed_forward { 1.0 } else { 0.0 };
        let forward = &acceleration.drives * fed - matrix.disturbance() * (matrix.mu() - 1.0);
        let s0 = back.solve(&position.drives)?;
        let s1 = back.solve(&(&velocity.drives - &s0 * t))?;
        let s2 = back.solve(&(&forward - &s1 * t - &s0 * (0.5 * t * t)))?;
        let borne = ((matrix.mu() - 1.0) / matrix.mu(), matrix.unit());
        Some(Self { a, period: t, borne, forward, s: [s0, s1, s2] })
    }

    /// `Σ_j |c A^j b|`, and its tail, over whatever `b` gives for each `c A^j`.
    fn sum(
        &self,
        entry: usize,
        (horizon, size): (Horizon, f64),
        mut of: impl FnMut(&OutputRow<'_>) -> f64,
    ) -> f64 {
        let mut row = DVector::zeros(self.a.nrows());
        row[entry] = if entry == 0 { 1.0 } else { self.borne.1 };
        let mut total = 0.0;
        let rows = sweep(self.a, &row, horizon, |row, _| total += of(row));
        total + horizon.tail(rows, size)
    }

    /// State that an acceleration held over one interval leaves in addition to that which follows.
    fn leaves(&self) -> DVector<f64> {
        let t = self.period;
        let [s0, s1, _] = &self.s;
        &self.forward - s1 * t - s0 * (0.5 * t * t)
    }

    /// To the entry of `e` (0) or of `ė` (1).
    fn acceleration(&self, entry: usize, horizon: Horizon) -> f64 {
        let leaves = self.leaves();
        self.sum(entry, (horizon, leaves.amax()), |row| row.dot(&leaves).abs())
    }

    /// A jerk at the share `1 − u` of an interval adds `(T²u²/2, Tu, 1)` to `r`: a parabola in `u`.
    fn jerk(&self, entry: usize, horizon: Horizon) -> Option<f64> {
        let [s0, s1, s2] = &self.s;
        if s2[entry].abs() > NONE {
            return None;
        }
        let t = self.period;
        let (share, unit) = self.borne;
        let at = |u: f64| {
            let mut leaves = s0 * (0.5 * t * t * u * u) + s1 * (t * u) + s2;
            leaves[0] -= share * 0.5 * t * t * u * u;
            leaves[1] -= share * t * u / unit;
            leaves
        };
        let (late, middle, early) = (at(0.0), at(0.5), at(1.0));
        let size = late.amax().max(middle.amax()).max(early.amax());
        let mean = |row: &OutputRow<'_>| {
            t * mean_of_parabola(row.dot(&early), row.dot(&middle), row.dot(&late))
        };
        Some(self.sum(entry, (horizon, t * size), mean))
    }
}
