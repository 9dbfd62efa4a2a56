//! What the reference's own motion costs: the part of the error that no unknown torque causes.

use serde::{Deserialize, Serialize};

/// Peak-to-peak gains from the reference's acceleration and jerk to `e` and `ė`, worst over inertia ratios.
///
/// A velocity that is filtered or differenced is late, and so is a torque behind a delay or a drive: following
/// an accelerated reference costs an error even where `φ` is zero. Without the feed-forward `M̄ q̈_d`, all of
/// that torque has to be found by the estimator. `φ` is what is asked for along the reference,
/// `τ(q_d, q̇_d, q̈_d) − M̄ q̈_d`, so that `(M − M̄) q̈_d` counts there and not here.
///
/// # Claim
///
/// From rest on the reference, at every sample, and in addition to what `φ` and the encoder cause:
///
/// ```text
/// |e| ≤ acceleration max|q̈_d|    (q̈_d held over each sample interval)
/// |e| ≤ jerk max|q⃛_d|            (q̈_d continuous, q̈_d(0) = 0)                                  (S2)
/// |ė| likewise, by the gains named after the velocity
/// ```
///
/// # Method
///
/// With the reference state `r = (q_d, q̇_d, q̈_d)`, `r_{k+1} = Φ r_k`, and `x_{k+1} = A x_k + R r_k` (in which
/// `(1 − μ) q̈_d` stands for what `φ` has of it), the loop would follow along `x = S r` where `SΦ = AS + R`; what
/// a jerk adds to `x − S r` dies out by `A`.
///
/// # Evidence
///
/// L1 norms with their tails bounded, computed again by [`Self::verify`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceError {
    /// Whether `M̄ q̈_d` is fed forward.
    pub feed_forward: bool,
    /// Inertia ratios tried.
    pub mu: Vec<f64>,
    /// From `q̈_d` to `e` \[rad/(rad/s²)\].
    pub acceleration: f64,
    /// From the jerk to `e` \[rad/(rad/s³)\]; `None`: a constant acceleration leaves an error that stays.
    pub jerk: Option<f64>,
    /// From `q̈_d` to `ė` \[(rad/s)/(rad/s²)\].
    pub velocity_acceleration: f64,
    /// From the jerk to `ė` \[(rad/s)/(rad/s³)\]; `None`: as above.
    pub velocity_jerk: Option<f64>,
}
