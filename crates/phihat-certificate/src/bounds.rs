//! Bounds on one joint's error, from peak-to-peak gains and a known `φ`.

use serde::{Deserialize, Serialize};

/// Guaranteed bounds on one joint's steady error.
///
/// # Claim
///
/// ```text
/// |e|, |ė| ≤ (ramp |φ̇_smooth| + jump |φ_jump|)/M̄ + reading Δ/2 + min(acceleration |q̈_d|, jerk |q⃛_d|)
///   and, measurements arriving s samples late, + sT |q̇_d| on e, + sT |q̈_d| on ė
/// |∫e|     ≤ from φ with its own gains + t · (|e| from encoder and motion) + T |e| + t · K_d T² |φ̇|/(12 K_p low M̄)
/// ```
///
/// The reference's own motion counts where it is known: see [`crate::Phi::motion`].
/// A constant misreading of the encoder is a constant error, so `∫e` grows with the time `t` of the run; the last
/// term is what a `φ` that varies within the sample intervals adds where the observer reads a true velocity.
///
/// # Not claimed
///
/// The error caused by the reference's own motion, if [`crate::Phi::motion`] is not known: it comes on top.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// `|e|` \[rad\].
    #[serde(alias = "error_rad")]
    pub error_bound_rad: f64,
    /// `|ė|` \[rad/s\].
    #[serde(alias = "velocity_error_rad_s")]
    pub velocity_error_bound_rad_s: f64,
    /// `|∫e|` \[rad·s\], for a run as long as the certificate says; `None`: grows without bound.
    pub integral_rad_s: Option<f64>,
}
