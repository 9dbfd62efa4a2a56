//! Bounds on the unknown dynamics.

use serde::{Deserialize, Serialize};

/// Bounds on one joint's `φ`, split into a smooth part and jumps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Phi {
    /// Kind of knowledge.
    pub basis: PhiBasis,
    /// Source of the bounds, in words.
    pub source: String,
    /// Largest |φ| \[N·m\]; `None`: not known, or not needed.
    pub size_nm: Option<f64>,
    /// Largest |φ̇| of the smooth part \[N·m/s\].
    pub rate_nm_s: f64,
    /// Largest size of the part that jumps \[N·m\].
    pub jump_nm: f64,
    /// Bounds on the reference, whose motion costs an error of its own; `None`: not known, and not in the
    /// bounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<ReferenceBounds>,
}

/// Bounds on one joint's reference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceBounds {
    /// Largest |q̇_d| \[rad/s\].
    #[serde(default)]
    pub velocity_rad_s: f64,
    /// Largest |q̈_d| \[rad/s²\].
    pub acceleration_rad_s2: f64,
    /// Largest |q⃛_d| \[rad/s³\].
    pub jerk_rad_s3: f64,
}

impl ReferenceBounds {
    /// Error that the motion causes, through gains from acceleration and jerk.
    pub fn costs(&self, acceleration: f64, jerk: Option<f64>) -> f64 {
        let held = acceleration * self.acceleration_rad_s2;
        jerk.map_or(held, |jerk| held.min(jerk * self.jerk_rad_s3))
    }
}

/// Basis of bounds on `φ`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PhiBasis {
    /// Typed by the user.
    Typed,
    /// Inverse dynamics along the reference.
    Reference,
    /// A simulation of the closed loop.
    Simulation,
    /// A recorded trace.
    Trace,
}

impl Phi {
    /// Response to a signal with these bounds, at most, through a peak-to-peak gain `jump` from `φ`, and
    /// `ramp` from `φ̇`: `ramp |φ̇_smooth| + jump |φ_jump|`, or `jump |φ|` where the size is known and gives
    /// less.
    pub fn bound(&self, jump: f64, ramp: Option<f64>) -> f64 {
        let smooth = ramp.map_or(f64::INFINITY, |gain| gain * self.rate_nm_s);
        let by_parts = smooth + jump * self.jump_nm;
        self.size_nm.map_or(by_parts, |size| by_parts.min(jump * size))
    }
}
