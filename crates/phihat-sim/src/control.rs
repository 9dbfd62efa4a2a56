//! The control side: from what was sensed to the torque that is asked for.

use phihat::{Command, JointGains, JointState, Limits, Reference, update_joints};
use phihat_study::Study;

use crate::error::SimError;
use crate::motion::Motion;
use crate::sample::Sample;

/// The law with its limits, and the reference it follows. It knows of the world what a [`Sample`] says.
#[derive(Debug)]
pub(crate) struct ControlSide {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    motion: Motion,
    pub(crate) references: Vec<Reference<f64>>,
    pub(crate) commands: Vec<Command<f64>>,
}

impl ControlSide {
    /// Puts the study's torque limits behind the gains.
    pub(crate) fn new(
        study: &Study,
        gains: &[JointGains<f64>],
        motion: Motion,
    ) -> Result<Self, SimError> {
        let n = gains.len();
        Ok(Self {
            gains: limited(study, gains)?,
            states: vec![JointState::new(); n],
            motion,
            references: vec![Reference::default(); n],
            commands: vec![Command::default(); n],
        })
    }

    /// One control sample at time `t` \[s\]; leaves `references` and `commands`. A controller that does
    /// not run leaves the commands as they are.
    pub(crate) fn step(&mut self, t: f64, sample: &Sample, runs: bool) {
        for (i, reference) in self.references.iter_mut().enumerate() {
            let [q, dq, ddq] = self.motion.at(i, t);
            *reference = Reference { q, dq, ddq };
        }
        if !runs {
            return;
        }
        update_joints(
            &self.gains,
            &mut self.states,
            &sample.joints,
            &self.references,
            &mut self.commands,
        );
    }

    /// Nominal inertia of a joint \[kg·m²\].
    pub(crate) fn inertia(&self, joint: usize) -> f64 {
        self.gains[joint].inertia()
    }
}

fn limited(study: &Study, gains: &[JointGains<f64>]) -> Result<Vec<JointGains<f64>>, SimError> {
    let period = study.control.period_ns as f64 * 1e-9;
    let per = |values: &Option<Vec<f64>>, i: usize| values.as_ref().map(|v| v[i]);
    let with = |(i, gains): (usize, &JointGains<f64>)| {
        let torque = per(&study.control.torque_max, i);
        let rate = per(&study.control.torque_rate_max, i);
        let limits = Limits::new(torque, rate, period)
            .map_err(|e| SimError::Limit(format!("{}: {e}", study.robot.joints[i].name)))?;
        Ok(gains.with_limits(limits))
    };
    gains.iter().enumerate().map(with).collect()
}
