//! What peak-to-peak gains and a known `φ` say about one joint's error.

use serde::{Deserialize, Serialize};

use crate::check::plausible::enough;
use crate::refutation::refuse;
use crate::{Certificate, JointCertificate, JointRecord, LoopForm, LoopVelocity, Refutation};

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
/// Where [`crate::Phi::motion`] is not known, what the motion of the reference costs by itself comes on top.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// `|e|` \[rad\].
    pub error_rad: f64,
    /// `|ė|` \[rad/s\].
    pub velocity_error_rad_s: f64,
    /// `|∫e|` \[rad·s\], for a run as long as the certificate says; `None`: grows without bound.
    pub integral_rad_s: Option<f64>,
}

const CLAIM: &str = "error bound";

impl JointCertificate {
    /// The bounds must not be below what gains and `φ` give.
    pub(crate) fn verify_bounds(
        &self,
        record: &JointRecord,
        whole: &Certificate,
    ) -> Result<(), Refutation> {
        let yes = Refutation::unless;
        let (Some(bounds), Some(phi)) = (&self.bounds, &self.phi) else {
            let neither = self.bounds.is_none();
            return yes(CLAIM, "a bound needs a φ to be a bound for", 1.0, 0.0, neither);
        };
        let Some(peaks) = &self.sampled else {
            return Err(refuse(CLAIM, "a bound needs peak gains", 1.0, 0.0));
        };
        let told = phi.motion.is_none() || self.reference.is_some();
        yes(CLAIM, "a motion costs what the reference error says", 0.0, 0.0, told)?;
        let model = &self.model;
        let inertia = record.inertia_kg_m2;
        let half = self.noise.as_ref().map_or(0.0, |noise| 0.5 * noise.quantum_rad);
        // What an entry of (∫e, e, ė) gets from φ: parts, or the whole where that is less.
        let from_phi = |i: usize| {
            let smooth = peaks.ramp[i].map_or(f64::INFINITY, |gain| gain * phi.rate_nm_s);
            let parts = smooth + peaks.jump[i] * phi.jump_nm;
            let whole = phi.size_nm.map_or(f64::INFINITY, |size| peaks.jump[i] * size);
            parts.min(whole) / inertia
        };
        let late = f64::from(model.sample_delay_samples) * model.period_s;
        let (mut error, mut velocity) = (0.0, 0.0);
        if let Some(reading) = &self.reading {
            error += reading.error * half;
            velocity += reading.velocity_per_s * half;
        }
        if let (Some(motion), Some(moved)) = (phi.motion, &self.reference) {
            let cost = |held: f64, jerk: Option<f64>| {
                let held = held * motion.acceleration_rad_s2;
                jerk.map_or(held, |gain| held.min(gain * motion.jerk_rad_s3))
            };
            error += cost(moved.acceleration, moved.jerk) + late * motion.velocity_rad_s;
            velocity += cost(moved.velocity_acceleration, moved.velocity_jerk)
                + late * motion.acceleration_rad_s2;
        }
        // φ that varies within the intervals shifts a true velocity by T²φ̇/(12M).
        let seen = model.form == LoopForm::Observer && model.velocity == LoopVelocity::Measured;
        let within = if seen {
            let shift =
                model.period_s * model.period_s * phi.rate_nm_s / (12.0 * whole.arm.low * inertia);
            record.kd_per_s / record.kp_per_s2 * shift
        } else {
            0.0
        };
        let least = from_phi(1) + error;
        enough(CLAIM, "gains × φ ≤ claimed |e|", least, bounds.error_rad)?;
        let found = from_phi(2) + velocity;
        enough(CLAIM, "gains × φ ≤ claimed |ė|", found, bounds.velocity_error_rad_s)?;
        let Some(claimed) = bounds.integral_rad_s else { return Ok(()) };
        let found = from_phi(0) + whole.duration_s * (error + within) + model.period_s * least;
        enough(CLAIM, "gains × φ ≤ claimed |∫e|", found, claimed)
    }
}
