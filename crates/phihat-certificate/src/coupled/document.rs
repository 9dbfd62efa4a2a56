//! Coupled gains as data.

use serde::{Deserialize, Serialize};

use crate::Matrix;

/// Peak-to-peak gains from a push on each joint to the error of every joint: the whole arm's loop at frozen
/// postures.
///
/// # Claim
///
/// The arm stands still at one of the postures searched, its inertia `M(q)` constant; from rest, at all
/// times, between the samples too, for external torques `d(t)` of any shape in time and reading errors `n_k`
/// of any sequence:
///
/// ```text
/// |e_i(t)|        ≤ Σ_j error_ij max|d_j|        + Σ_j encoder_error_ij max|n_j|                          as (G1)
/// |ė_i(t)|        ≤ Σ_j velocity_ij max|d_j|     + Σ_j encoder_velocity_ij max|n_j|
/// |ë_i(t)|        ≤ Σ_j acceleration_ij max|d_j|                                                   (without encoder)
/// |τ_i,k − τ_i,k−1| ≤ Σ_j torque_step_ij max|d_j| + Σ_j encoder_torque_step_ij max|n_j|  (commanded torque)
/// ```
///
/// Each row is reached, within the margin that the finder adds, by a signal that takes the signs of the
/// impulse response.
///
/// # Not claimed
///
/// Motion: `d` is what comes from outside (push, friction, gravity of a posture), not `φ`, of which
/// `(M − M̄)q̈` is a part. Postures and payloads that were not searched. Viscous friction and the gradient of
/// gravity, which are not in this loop. Limits in action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoupledGains {
    /// Searched postures, in words.
    pub source: String,
    /// Number of frozen postures that were summed up exactly.
    pub postures: u32,
    /// From torque to `e` \[rad/(N·m)\], row: the joint that moves, column: the joint that is pushed.
    pub error_rad_per_nm: Matrix,
    /// From torque to `ė` \[rad/s/(N·m)\].
    pub velocity_rad_s_per_nm: Matrix,
    /// From torque to `ë` \[rad/s²/(N·m)\].
    pub acceleration_rad_s2_per_nm: Matrix,
    /// From torque to the change of the commanded torque per sample \[N·m/(N·m)\].
    pub torque_step_nm_per_nm: Matrix,
    /// From the encoder's error to `e` \[rad/rad\].
    pub encoder_error_rad_per_rad: Matrix,
    /// From the encoder's error to `ė` \[1/s\].
    pub encoder_velocity_per_s: Matrix,
    /// From the encoder's error to the change of the commanded torque per sample \[N·m/rad\].
    pub encoder_torque_step_nm_per_rad: Matrix,
    /// The postures at which the largest entry of each row was found.
    pub witnesses: Vec<FrozenPosture>,
}

/// A posture with its payload, and the inertia that the arm has there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenPosture {
    /// Source of the posture, in words.
    pub source: String,
    /// Joint positions \[rad\].
    pub q_rad: Vec<f64>,
    /// Payload of the arm there; `None`: no payload.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub payload: Option<FrozenPayload>,
    /// `M(q)` \[kg·m²\], rotors included.
    pub mass_matrix_kg_m2: Matrix,
}

/// A body held by the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenPayload {
    /// Frame that holds it.
    pub frame: String,
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Centre of mass in that frame \[m\].
    pub com_m: [f64; 3],
    /// Inertia about the centre of mass \[kg·m²\]: xx, xy, xz, yy, yz, zz.
    pub inertia_kg_m2: [f64; 6],
}

impl CoupledGains {
    /// Strongest coupling of two different joints: the joint that moves, the joint that is pushed, and the
    /// gain \[rad/(N·m)\]. `None` for one joint.
    pub fn strongest(&self) -> Option<(usize, usize, f64)> {
        let rows = self.error_rad_per_nm.iter().enumerate();
        let entries =
            rows.flat_map(|(i, row)| row.iter().enumerate().map(move |(j, x)| (i, j, *x)));
        entries.filter(|(i, j, _)| i != j).max_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// The matrices of coupled gains with what each is, in the order of the claim.
    pub fn matrices(&self) -> [(&'static str, &Matrix); 7] {
        [
            ("e ← torque", &self.error_rad_per_nm),
            ("ė ← torque", &self.velocity_rad_s_per_nm),
            ("ë ← torque", &self.acceleration_rad_s2_per_nm),
            ("Δτ ← torque", &self.torque_step_nm_per_nm),
            ("e ← encoder", &self.encoder_error_rad_per_rad),
            ("ė ← encoder", &self.encoder_velocity_per_s),
            ("Δτ ← encoder", &self.encoder_torque_step_nm_per_rad),
        ]
    }
}
