//! Torque noise from the encoder's resolution.

use core::f64::consts::TAU;

use serde::{Deserialize, Serialize};

/// What a joint's encoder makes of the torque, worst over some inertia ratios.
///
/// # Law
///
/// Encoder error white and even over one quantum `Δ`, rms `Δ/√12`, through the closed loop `h` from encoder
/// to commanded torque:
///
/// ```text
/// rms τ = M̄ Δ/√12 ‖h‖₂,    rms (τ_k − τ_{k−1}) = M̄ Δ/√12 ‖h_k − h_{k−1}‖₂,    |τ_k − τ_{k−1}| ≤ M̄ Δ/2 ‖h_k − h_{k−1}‖₁
/// ```
///
/// # Claim
///
/// The last one holds for any sequence of quantisation errors. The two rms values hold where successive
/// errors are uncorrelated: a joint that crosses about a quantum or more per sample.
///
/// # Not claimed
///
/// At rest an encoder may show less noise (no quantum crossed) or a limit cycle inside the bound. Ratios
/// between those tried are not proved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueNoise {
    /// Quantum of the position \[rad\].
    pub quantum_rad: f64,
    /// Inertia ratios tried.
    pub mu: Vec<f64>,
    /// rms of the torque \[N·m\].
    pub rms_nm: f64,
    /// rms of the torque's change from sample to sample \[N·m\].
    pub change_rms_nm: f64,
    /// Bound of that change \[N·m\].
    pub change_max_nm: f64,
}

impl TorqueNoise {
    /// Quantum of an encoder with `bits` per revolution \[rad\].
    pub fn quantum(bits: u32) -> f64 {
        TAU / 2.0_f64.powi(i32::try_from(bits).unwrap_or(i32::MAX))
    }
}
