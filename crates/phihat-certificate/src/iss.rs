//! Input-to-state stability of the closed loop, with explicit constants.

use serde::{Deserialize, Serialize};

use crate::{Matrix, PeakGain};

/// `ẋ = (A − BK)x − Bφ` is input-to-state stable.
///
/// # Claim
///
/// With `V = ½xᵀSx` (30) and `W = −(A−BK)ᵀS − S(A−BK)`; for the certificate's `S` this is
/// `W = Q + (2a_{m−1} − K̃) SBBᵀS`:
///
/// ```text
/// s_min I ≼ S ≼ s_max I                                                        (26)
/// W ≽ w_min I:   V̇ ≤ −γ₁|x|² + γ₂φ²,   γ₁ = w_min/4,  γ₂ = |SB|²/w_min           (27)
///                |x| ≥ ρ|φ|  ⟹  V̇ ≤ −γ₁|x|²,   ρ = 4|SB|/w_min                  (28)
/// W ≽ 2λS:       |x(t)| ≤ √(s_max/s_min) e^{−λt} |x(0)|   at φ = 0               (24)
/// |x(t)| ≤ … + gain |φ|_∞,   gain = ‖B‖ ∫‖e^{(A−BK)τ}‖dτ,  ‖B‖ = 1                (25)
/// ```
///
/// The paper's α: `a_{m−1} = αK̃ + 1/γ²` needs `α > ½`, here `a_{m−1} > K̃/2`, so that `W ≽ Q`.
///
/// # Not claimed
///
/// `|x|` mixes rad·s, rad and rad/s as in the paper; the constants are large for that reason alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Iss {
    /// `K̃` whose `S` this is; `None`: some other Lyapunov matrix.
    pub k_tilde: Option<f64>,
    /// `S`.
    pub s: Matrix,
    /// Below the smallest eigenvalue of `S`.
    pub s_min: f64,
    /// Above the largest eigenvalue of `S`.
    pub s_max: f64,
    /// `√(s_max/s_min)`.
    pub overshoot: f64,
    /// Decay rate `λ` \[1/s\].
    pub rate: f64,
    /// Below the smallest eigenvalue of `W`.
    pub w_min: f64,
    /// `|SB|`.
    pub sb_norm: f64,
    /// `γ₁` of (27).
    pub gamma1: f64,
    /// `γ₂` of (27).
    pub gamma2: f64,
    /// Gain of (25); the upper side uses the Frobenius norm, the lower one is `1/√n` of it.
    pub gain: PeakGain,
}

impl Iss {
    /// `|x(t)|` at φ = 0 is at most this \[1\], per unit of `|x(0)|`.
    pub fn beta(&self, time_s: f64) -> f64 {
        self.overshoot * (-self.rate * time_s).exp()
    }
}
