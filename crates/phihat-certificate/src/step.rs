//! The largest step of the reference that no limit has to cut.

use serde::{Deserialize, Serialize};

/// How far `q_d` may jump (with `q̇_d = q̈_d = 0`) so that neither torque nor torque rate reaches its limit.
///
/// # Claim
///
/// From rest without load, for every inertia ratio tried, `|τ_k| ≤ τ_max` and `|τ_k − τ_{k−1}| ≤ τ̇_max T` at
/// all samples after a step of at most `step_rad`: the loop stays linear, so its stability is that of
/// the inertia window. The response is linear in the step; with a load the torque left counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LargestStep {
    /// The step \[rad\]; `None`: no limit is stated.
    pub step_rad: Option<f64>,
    /// Largest |τ| after a step of 1 rad \[N·m\].
    pub torque_per_rad_nm: f64,
    /// Largest |τ_k − τ_{k−1}| after a step of 1 rad \[N·m\].
    pub change_per_rad_nm: f64,
    /// Inertia ratios tried.
    pub mu: Vec<f64>,
}
