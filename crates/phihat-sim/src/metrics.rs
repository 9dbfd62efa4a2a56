//! What a person reads first: one row of figures per joint.

use serde::{Deserialize, Serialize};

/// Figures of one joint over a run. "Steady" means: after `Spec::settle`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointMetrics {
    /// Joint name.
    pub name: String,
    /// Root mean square of `e` over the steady part \[rad\].
    pub error_rms_rad: f64,
    /// Largest |e| of the whole run \[rad\].
    pub error_max_rad: f64,
    /// Largest |e| of the steady part \[rad\].
    pub error_steady_max_rad: f64,
    /// The study's bound on it, if it states one \[rad\].
    pub error_spec_rad: Option<f64>,
    /// Largest |∫e| of the steady part \[rad·s\].
    pub error_integral_steady_max_rad_s: f64,
    /// The study's bound on it \[rad·s\].
    pub error_integral_spec_rad_s: Option<f64>,
    /// Largest |ė| of the steady part \[rad/s\].
    pub velocity_error_steady_max_rad_s: f64,
    /// The study's bound on it \[rad/s\].
    pub velocity_error_spec_rad_s: Option<f64>,
    /// Largest |τ_applied| \[N·m\].
    pub tau_max_nm: f64,
    /// The torque limit in force \[N·m\].
    pub tau_limit_nm: Option<f64>,
    /// Largest change of the commanded torque from one sample to the next \[N·m\].
    pub tau_step_max_nm: f64,
    /// The torque-rate limit in force, per sample \[N·m\].
    pub tau_step_limit_nm: Option<f64>,
    /// Samples whose command met the torque limit.
    pub saturated_samples: u64,
    /// Samples whose command met the torque-rate limit.
    pub rate_limited_samples: u64,
    /// Largest |φ| \[N·m\].
    pub phi_max_nm: f64,
    /// Largest |φ − φ̂| of the steady part \[N·m\].
    pub phi_error_steady_max_nm: f64,
}

/// Figures of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Simulated time \[s\].
    pub duration_s: f64,
    /// Where the steady part begins \[s\].
    pub settle_s: f64,
    /// Number of control samples.
    pub samples: u64,
    /// Whether every stated bound holds on every joint.
    pub within_spec: bool,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointMetrics>,
}
