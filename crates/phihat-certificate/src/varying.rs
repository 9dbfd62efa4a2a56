//! Inertia that changes while the arm moves: one quadratic form for a whole range.

use serde::{Deserialize, Serialize};

/// A range of inertia ratios through which the arm may move, at any speed.
///
/// # Claim
///
/// For the continuous law, one or more joints with these same gains, and `W(t) = M̄^{1/2} M(q(t))⁻¹ M̄^{1/2}`
/// varying in any way with eigenvalues in `[1/high, 1/low]`, `V = xᵀ(P ⊗ I)x` decreases along
///
/// ```text
/// x = (∫…∫e, …, ∫e, e, ė),   x_i' = x_{i+1},   ė' = −W (k_1 x_1 + … + k_{m+2} x_{m+2})
/// D(s) A_o(s) = s^{m+2} + k_{m+2} s^{m+1} + … + k_1                                           (V1)
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
/// x_{k+1} = A(W_k) x_k,   A(1/μ) the state matrix of the loop                                       (V2)
/// ```
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
    /// `P`, row by row, for the state of [`StateMatrix`].
    pub p: Vec<Vec<f64>>,
}
