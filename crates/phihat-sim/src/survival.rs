//! Result of a run under faults: the figures of one cell of a fault matrix.

use core::convert::Infallible;
use std::collections::VecDeque;

use phihat_study::Study;
use serde::{Deserialize, Serialize};

use crate::metrics::raise;
use crate::recorder::Recorder;
use crate::simulation::{Ended, SimulationOutcome};
use crate::trace::Trace;

/// Figures of a run in which something went wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Survival {
    /// True if the arm stayed finite and within every plausible bound to the end.
    pub finite: bool,
    /// Why the robot's interface stopped the run, if it did.
    pub stopped: Option<String>,
    /// Largest |e| of any joint from the first fault on \[rad\]; of the whole run where there is none.
    #[serde(alias = "error_max_rad")]
    pub error_peak_rad: f64,
    /// Largest |e| of any joint over the last tenth of the run \[rad\].
    pub error_end_rad: f64,
    /// Largest |q̇| of any joint from the first fault on \[rad/s\].
    pub velocity_max_rad_s: f64,
    /// True if no drive was commanded more than the torque limit.
    pub torque_kept: bool,
    /// True if no drive was commanded to change its torque faster than the rate limit.
    pub torque_rate_kept: bool,
}

impl Survival {
    /// Figures of a run against its study's limits.
    pub fn of(outcome: &SimulationOutcome, study: &Study) -> Self {
        let mut surviving = Surviving::new(study);
        surviving.block(&outcome.trace);
        let (divergence, abort) = (outcome.divergence.clone(), outcome.abort.clone());
        let (told_max, told_step_max) = (outcome.told_max.clone(), outcome.told_step_max.clone());
        let ended = Ended { divergence, abort, told_max, told_step_max, contact: None };
        surviving.survival(&ended, study)
    }
}

/// The figures of [`Survival`] while the record of a run goes by.
#[derive(Debug, Clone)]
pub struct Surviving {
    /// From when on the whole run counts \[ns\].
    from_ns: f64,
    samples: usize,
    error_peak: f64,
    velocity_max: f64,
    /// Candidates for the largest error of the last tenth, wherever the run ends: in order, their errors
    /// falling.
    last: VecDeque<(usize, f64)>,
}

impl Surviving {
    /// Figures before the first sample of a study's run.
    pub fn new(study: &Study) -> Self {
        let fault = study.faults.iter().map(|fault| fault.start).fold(f64::INFINITY, f64::min);
        let from_ns = if fault.is_finite() { fault * 1e9 } else { f64::NEG_INFINITY };
        let last = VecDeque::new();
        Self { from_ns, samples: 0, error_peak: 0.0, velocity_max: 0.0, last }
    }

    /// Takes in the next samples.
    pub fn block(&mut self, trace: &Trace) {
        let first = trace.t_ns.partition_point(|t| (*t as f64) < self.from_ns);
        for joint in &trace.joints {
            raise(&mut self.error_peak, joint.e.iter().skip(first).copied());
            raise(&mut self.velocity_max, joint.dq.iter().skip(first).copied());
        }
        for k in 0..trace.len() {
            let mut worst = 0.0;
            raise(&mut worst, trace.joints.iter().filter_map(|joint| joint.e.get(k).copied()));
            // Not a number counts as worst.
            while self.last.back().is_some_and(|(_, other)| other.total_cmp(&worst).is_le()) {
                self.last.pop_back();
            }
            self.last.push_back((self.samples, worst));
            self.samples += 1;
            self.forget();
        }
    }

    /// The last tenth never begins earlier than it would now.
    fn forget(&mut self) {
        let begin = self.samples - self.samples / 10;
        while self.last.front().is_some_and(|(k, _)| *k < begin) {
            self.last.pop_front();
        }
    }

    /// The figures of a run that ended so.
    pub fn survival(&self, ended: &Ended, study: &Study) -> Survival {
        let period = study.control.period_ns as f64 * 1e-9;
        let kept = |told: &[f64], limit: &dyn Fn(usize) -> Option<f64>| {
            let within = |(joint, told): (usize, &f64)| {
                limit(joint).is_none_or(|limit| *told <= limit * (1.0 + 1e-9))
            };
            told.iter().enumerate().all(within)
        };
        let torque = |joint| study.limits(joint).0;
        let step = |joint| study.limits(joint).1.map(|rate| rate * period);
        Survival {
            finite: ended.divergence.is_none(),
            stopped: ended.abort.as_ref().map(|abort| abort.reason.to_string()),
            error_peak_rad: self.error_peak,
            error_end_rad: self.last.front().map_or(0.0, |(_, error)| *error),
            velocity_max_rad_s: self.velocity_max,
            torque_kept: kept(&ended.told_max, &torque),
            torque_rate_kept: kept(&ended.told_step_max, &step),
        }
    }
}

impl Recorder for Surviving {
    type Error = Infallible;

    fn take(&mut self, block: &mut Trace) -> Result<(), Infallible> {
        self.block(block);
        Ok(())
    }
}
