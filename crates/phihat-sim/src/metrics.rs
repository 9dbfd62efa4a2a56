//! What a person reads first: one row of figures per joint.

use phihat_study::Study;
use serde::{Deserialize, Serialize};

use crate::trace::{JointTrace, Trace};

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
    /// Samples of the steady part whose command met the torque limit.
    pub saturated_steady_samples: u64,
    /// Samples of the steady part whose command met the torque-rate limit.
    pub rate_limited_steady_samples: u64,
    /// Share of the samples of the steady part whose command met either.
    pub limited_steady_share: f64,
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
    /// Number of control samples of the steady part.
    pub steady_samples: u64,
    /// Share of the commands of all joints in the steady part that met a limit: no claim about gains speaks of these.
    pub limited_steady_share: f64,
    /// Whether every stated bound holds on every joint.
    pub within_spec: bool,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointMetrics>,
}

impl Metrics {
    /// Figures of a trace against a study's bounds and limits.
    pub fn of(trace: &Trace, study: &Study) -> Self {
        let settle_s = study.spec.settle;
        let first = trace.index_at(settle_s);
        let joint = |(i, joint): (usize, &JointTrace)| joint_metrics(joint, study, i, first);
        let joints: Vec<_> = trace.joints.iter().enumerate().map(joint).collect();
        let steady = trace.len().saturating_sub(first);
        let shares = joints.iter().map(|joint| joint.limited_steady_share);
        let limited = shares.sum::<f64>() / joints.len().max(1) as f64;
        let wanted = crate::simulation::samples(study.duration, study.control.period_ns);
        let complete = first < trace.len() && trace.len() as u64 >= wanted;
        Self {
            duration_s: trace.len() as f64 * trace.period_ns as f64 * 1e-9,
            settle_s,
            samples: trace.len() as u64,
            steady_samples: steady as u64,
            limited_steady_share: limited,
            within_spec: complete && joints.iter().all(JointMetrics::within_spec),
            joints,
        }
    }
}

impl JointMetrics {
    /// Whether every bound that the study states holds on this joint.
    pub fn within_spec(&self) -> bool {
        // Written so that NaN does not pass.
        let holds = |value: f64, bound: Option<f64>| bound.is_none_or(|bound| value <= bound);
        holds(self.error_steady_max_rad, self.error_spec_rad)
            && holds(self.error_integral_steady_max_rad_s, self.error_integral_spec_rad_s)
            && holds(self.velocity_error_steady_max_rad_s, self.velocity_error_spec_rad_s)
    }
}

fn joint_metrics(joint: &JointTrace, study: &Study, i: usize, first: usize) -> JointMetrics {
    let per = |values: &Option<Vec<f64>>| values.as_ref().and_then(|v| v.get(i)).copied();
    let steady = |values: &[f64]| largest(values.get(first..).unwrap_or(&[]).iter().copied());
    let errors = joint.e.get(first..).unwrap_or(&[]);
    let squares = errors.iter().fold(0.0, |sum, e| sum + e * e);
    let misfit = joint.phi.iter().zip(&joint.phi_hat).skip(first).map(|(a, b)| a - b);
    let steps = joint.tau_command.windows(2).map(|w| w[1] - w[0]);
    let count = |flags: &[bool]| flags.iter().filter(|f| **f).count() as u64;
    let after = |flags: &[bool]| count(flags.get(first..).unwrap_or(&[]));
    let either = joint.saturated.iter().zip(&joint.rate_limited).skip(first).map(|(a, b)| *a || *b);
    let limited = either.filter(|limited| *limited).count() as f64;
    let period = study.control.period_ns as f64 * 1e-9;
    let (torque_max, torque_rate_max) = study.limits(i);
    JointMetrics {
        name: joint.name.clone(),
        error_rms_rad: (squares / errors.len().max(1) as f64).sqrt(),
        error_max_rad: largest(joint.e.iter().copied()),
        error_steady_max_rad: steady(&joint.e),
        error_spec_rad: per(&study.spec.error_max),
        error_integral_steady_max_rad_s: steady(&joint.e_integral),
        error_integral_spec_rad_s: per(&study.spec.error_integral_max),
        velocity_error_steady_max_rad_s: steady(&joint.de),
        velocity_error_spec_rad_s: per(&study.spec.velocity_error_max),
        tau_max_nm: largest(joint.tau_applied.iter().copied()),
        tau_limit_nm: torque_max,
        tau_step_max_nm: largest(steps),
        tau_step_limit_nm: torque_rate_max.map(|rate| rate * period),
        saturated_samples: count(&joint.saturated),
        rate_limited_samples: count(&joint.rate_limited),
        saturated_steady_samples: after(&joint.saturated),
        rate_limited_steady_samples: after(&joint.rate_limited),
        limited_steady_share: limited / errors.len().max(1) as f64,
        phi_max_nm: largest(joint.phi.iter().copied()),
        phi_error_steady_max_nm: largest(misfit),
    }
}

/// Largest absolute value; NaN if there is one, 0 for none.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    let larger = |most: f64, value: f64| if value.abs() <= most { most } else { value.abs() };
    values.fold(0.0, |most, value| if most.is_nan() { most } else { larger(most, value) })
}
