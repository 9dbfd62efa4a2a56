//! What a run under faults came to: the figures of one cell of a fault matrix.

use phihat_study::Study;
use serde::{Deserialize, Serialize};

use crate::simulation::Outcome;

/// Figures of a run in which something went wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Survival {
    /// Whether the arm stayed finite and within every plausible bound to the end.
    pub finite: bool,
    /// Why the robot's interface stopped the run, if it did.
    pub stopped: Option<String>,
    /// Largest |e| of any joint from the first fault on \[rad\]; of the whole run where there is none.
    pub error_max_rad: f64,
    /// Largest |e| of any joint over the last tenth of the run \[rad\].
    pub error_end_rad: f64,
    /// Largest |q̇| of any joint from the first fault on \[rad/s\].
    pub velocity_max_rad_s: f64,
    /// Whether no drive was told more than the torque limit.
    pub torque_kept: bool,
    /// Whether no drive was told to change its torque faster than the rate limit.
    pub torque_rate_kept: bool,
}

impl Survival {
    /// Figures of a run against its study's limits.
    pub fn of(outcome: &Outcome, study: &Study) -> Self {
        let trace = &outcome.trace;
        let period = study.control.period_ns as f64 * 1e-9;
        let fault = study.faults.iter().map(|fault| fault.start).fold(f64::INFINITY, f64::min);
        let first = if fault.is_finite() { trace.index_at(fault) } else { 0 };
        let last = trace.len() - trace.len() / 10;
        let worst = |from: usize, column: fn(&crate::JointTrace) -> &Vec<f64>| {
            let values = trace.joints.iter().filter_map(|joint| column(joint).get(from..));
            // Not a number counts as worst.
            let larger = |most: f64, x: &f64| if x.abs() <= most { most } else { x.abs() };
            values
                .flatten()
                .fold(0.0_f64, |most, x| if most.is_nan() { most } else { larger(most, x) })
        };
        let kept = |told: &[f64], limit: &dyn Fn(usize) -> Option<f64>| {
            let within = |(joint, told): (usize, &f64)| {
                limit(joint).is_none_or(|limit| *told <= limit * (1.0 + 1e-9))
            };
            told.iter().enumerate().all(within)
        };
        let torque = |joint| study.limits(joint).0;
        let step = |joint| study.limits(joint).1.map(|rate| rate * period);
        Self {
            finite: outcome.divergence.is_none(),
            stopped: outcome.abort.as_ref().map(|abort| abort.reason.to_string()),
            error_max_rad: worst(first, |joint| &joint.e),
            error_end_rad: worst(last, |joint| &joint.e),
            velocity_max_rad_s: worst(first, |joint| &joint.dq),
            torque_kept: kept(&outcome.told_max, &torque),
            torque_rate_kept: kept(&outcome.told_step_max, &step),
        }
    }
}
