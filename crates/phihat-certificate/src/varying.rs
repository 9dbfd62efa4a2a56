//! Inertia that changes while the arm moves: one quadratic form for a whole range.

use serde::{Deserialize, Serialize};

use crate::check::decay::SignalLayout;
use crate::check::definite::definite;
use crate::check::plausible::{self, at_most};
use crate::check::sample::Loop;
use crate::refutation::refuse;
use crate::{JointRecord, LoopModel, Matrix, Refutation};

/// A range of inertia ratios through which the arm may move, at any speed.
///
/// # Claim
///
/// For the continuous law, one or more joints with these same gains, and `W(t) = M̄^{1/2} M(q(t))⁻¹ M̄^{1/2}`
/// varying in any way with eigenvalues in `[1/high, 1/low]`, `V = xᵀ(P ⊗ I)x` decreases along
///
/// ```text
/// x = (∫…∫e, …, ∫e, e, ė),   x_i' = x_{i+1},   ė' = −W (k_1 x_1 + … + k_{m+2} x_{m+2})
/// D(s) A_o(s) = s^{m+2} + k_{m+2} s^{m+1} + … + k_1                                          as (V1)
/// ```
///
/// # Evidence
///
/// `P`. The system is affine in `W`, so two matrix inequalities at the ends suffice: `P ≻ 0` and
/// `A_iᵀP + PA_i ≺ 0`, each checked by Cholesky.
///
/// # Not claimed
///
/// Coriolis torque is not in (V1): it enters as a disturbance. Sampling and delay are not in (V1): see
/// [`super::InertiaWindow`] for each frozen inertia.
///
/// # References
///
/// Shorten and Narendra (2003), King and Nathanson (2006): such a `P` exists iff `A_1`, `A_2` are Hurwitz and
/// `A_1A_2` has no negative real eigenvalue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VaryingWindow {
    /// Smallest `μ`.
    pub low: f64,
    /// Largest `μ`.
    pub high: f64,
    /// Unit of time of the state \[s⁻¹\]: entry `i` of `x` is multiplied by `rate^(n−i)`.
    pub rate_per_s: f64,
    /// `P`, row by row, in these units.
    pub p: Vec<Vec<f64>>,
}

/// A range of inertia ratios through which the arm may move from sample to sample, by any steps.
///
/// # Claim
///
/// For the loop as it is sampled, with its delay, velocity source, filter and drive; for one or more joints with
/// these same gains in this same loop; and `W_k = M̄^{1/2} M(q)⁻¹ M̄^{1/2}` constant over each sample interval, with
/// eigenvalues in `[1/high, 1/low]`, different in any way from one interval to the next: `V = xᵀ(P ⊗ I)x`
/// decreases at every sample along
///
/// ```text
/// x_{k+1} = A(W_k) x_k,   A(1/μ) the state matrix of the loop                                      as (V2)
/// ```
///
/// A filter on the innovation stands behind `φ̂` and its derivatives: `x`, `δ` of each section \[rad\].
///
/// # Evidence
///
/// `P`. `A` is affine in `W`, so `V(x_{k+1})` is convex in it, and the ends suffice: `P ≻ 0` and
/// `P − AᵀPA ≻ 0` at `low` and at `high`, each checked by Cholesky.
///
/// # Not claimed
///
/// Inertia that changes within an interval, and Coriolis torque: both enter as a disturbance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampledVarying {
    /// Smallest `μ`.
    pub low: f64,
    /// Largest `μ`.
    pub high: f64,
    /// `P`, row by row, for the state of `StateMatrix`.
    pub p: Vec<Vec<f64>>,
}

impl VaryingWindow {
    /// Checks `P ≻ 0` and, at both ends, that `xᵀPx` falls along (V1).
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality and its least pivot.
    pub fn verify(&self, gains: &JointRecord) -> Result<(), Refutation> {
        const CLAIM: &str = "varying inertia";
        plausible::gains(CLAIM, gains)?;
        let n = gains.a.len() + 2;
        range(CLAIM, (self.low, self.high))?;
        at_most(CLAIM, "0 < rate", f64::MIN_POSITIVE, self.rate_per_s)?;
        square(CLAIM, &self.p, n)?;
        definite(CLAIM, "P ≻ 0", &self.p)?;
        for (end, mu) in [("low", self.low), ("high", self.high)] {
            // x' = A x by columns, in units of the rate.
            let mut a = vec![vec![0.0; n]; n];
            for i in 1..n {
                a[i - 1][i] = 1.0;
            }
            for (j, k) in characteristic(gains).into_iter().enumerate() {
                let unit = (j..n).fold(1.0, |power, _| power * self.rate_per_s);
                a[n - 1][j] = -k / unit / mu;
            }
            let half = times(&self.p, &a);
            let falls = (0..n).map(|i| (0..n).map(|j| -half[i][j] - half[j][i]).collect());
            let falls: Matrix = falls.collect();
            definite(CLAIM, &format!("−(AᵀP + PA) ≻ 0 at {end}"), &falls)?;
        }
        Ok(())
    }
}

impl SampledVarying {
    /// Checks `P ≻ 0` and, at both ends, that `xᵀPx` falls from sample to sample.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality and its least pivot.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        const CLAIM: &str = "varying inertia, sampled";
        plausible::gains(CLAIM, gains)?;
        plausible::model(CLAIM, gains, model)?;
        range(CLAIM, (self.low, self.high))?;
        for (end, mu) in [("low", self.low), ("high", self.high)] {
            let of = Loop::new(gains, model, mu);
            let layout = SignalLayout::of(&of);
            square(CLAIM, &self.p, layout.len())?;
            definite(CLAIM, "P ≻ 0", &self.p)?;
            let a = layout.matrix(&of);
            let turned: Matrix =
                (0..a.len()).map(|i| a.iter().map(|row| row[i]).collect()).collect();
            let after = times(&turned, &times(&self.p, &a));
            let falls = self.p.iter().zip(&after);
            let falls = falls.map(|(p, q)| p.iter().zip(q).map(|(p, q)| p - q).collect()).collect();
            definite(CLAIM, &format!("P − AᵀPA ≻ 0 at {end}"), &falls)?;
        }
        Ok(())
    }
}

/// `D(s)A_o(s)` without its leading 1, ascending.
fn characteristic(gains: &JointRecord) -> Vec<f64> {
    let mut k = vec![0.0; gains.a.len() + 3];
    for (i, a) in gains.a.iter().chain([&1.0]).enumerate() {
        for (j, d) in [gains.kp_per_s2, gains.kd_per_s, 1.0].into_iter().enumerate() {
            k[i + j] += a * d;
        }
    }
    k.pop();
    k
}

fn range(claim: &str, (low, high): (f64, f64)) -> Result<(), Refutation> {
    at_most(claim, "0 < low", f64::MIN_POSITIVE, low)?;
    at_most(claim, "low ≤ high", low, high)?;
    at_most(claim, "high < ∞", high, f64::MAX)
}

/// `n × n`, finite, exactly symmetric.
fn square(claim: &str, p: &Matrix, n: usize) -> Result<(), Refutation> {
    let shaped = p.len() == n && p.iter().all(|row| row.len() == n);
    let finite = p.iter().flatten().all(|value| value.is_finite());
    let even = shaped && (0..n).all(|i| (0..i).all(|j| p[i][j].to_bits() == p[j][i].to_bits()));
    if finite && even {
        Ok(())
    } else {
        Err(refuse(claim, "P = Pᵀ, of the loop's size", p.len() as f64, n as f64))
    }
}

fn times(x: &Matrix, y: &Matrix) -> Matrix {
    let n = y.len();
    let entry = |row: &[f64], j: usize| (0..n).map(|k| row[k] * y[k][j]).sum();
    x.iter().map(|row| (0..n).map(|j| entry(row, j)).collect()).collect()
}
