//! A joint's law beside what no linear law undercuts.

use serde::{Deserialize, Serialize};

/// Error bound of a joint's law compared with the limit of linear laws. Informs: no claim, and nothing checks it.
///
/// # Reckoning
///
/// All errors are `(ramp·φ̇ + jump·φ_J)/M + read·Δ/2`, of this joint alone, with `φ` constant over each
/// sample and nothing of the reference's own motion. The limits are those of laws whose encoder noise in the
/// torque stays within `torque_noise_nm`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointLimit {
    /// Joint name.
    pub name: String,
    /// Source of the bounds on `φ`, in words.
    pub phi_source: String,
    /// Largest |φ̇| of the smooth part of `φ` \[N·m/s\].
    pub phi_rate_nm_s: f64,
    /// Largest size of the part of `φ` that jumps \[N·m\].
    pub phi_jump_nm: f64,
    /// Largest change of torque per sample that the encoder causes with these gains, over the arm's range of
    /// inertia \[N·m\].
    pub torque_noise_nm: f64,
    /// At `M̄`, known: no linear law has a smaller bound than the first, and one has the second \[rad\].
    pub limit_rad: (f64, f64),
    /// The same at the lightest inertia of the arm's range: no law for the whole range has a smaller bound \[rad\].
    pub limit_lightest_rad: (f64, f64),
    /// Bound of these gains at `M̄` \[rad\].
    pub own_rad: f64,
    /// The largest of their bounds at ratios of inertia over the arm's range \[rad\].
    pub range_rad: f64,
}

impl JointLimit {
    /// Bound of these gains at `M̄` over the limit there.
    pub fn times_limit(&self) -> f64 {
        self.own_rad / self.limit_rad.0
    }

    /// Price of not knowing the inertia: their bound over the whole range, over the limit at `M̄`.
    pub fn price_of_range(&self) -> f64 {
        self.range_rad / self.limit_rad.0
    }

    /// Their bound over the whole range over what no law for that range undercuts; at least the distance that is left.
    pub fn times_lightest(&self) -> f64 {
        self.range_rad / self.limit_lightest_rad.0
    }
}
