//! The control side: from what was sensed to the torque that is asked for.

use phihat::{Command, JointGains, JointState, Limits, Reference, Report, update_joints};
use phihat_study::{Interface, Study};

use crate::echo::Echo;
use crate::error::SimError;
use crate::motion::Motion;
use crate::sample::Sample;
use crate::supervision::Supervised;

/// The law with its limits, and the reference it follows. It knows of the world what a [`Sample`] says.
#[derive(Debug)]
pub(crate) struct ControlSide {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    /// In place of the bare law, where the study says so.
    supervised: Option<Box<Supervised>>,
    motion: Motion,
    /// Whether the next command must be zero: the robot's start rule.
    starts: bool,
    echo: Option<Echo>,
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
        let gains = limited(study, gains)?;
        let request = study.supervisor.as_deref();
        let supervised = request.map(|request| Supervised::new(study, request, &gains));
        Ok(Self {
            supervised: supervised.transpose()?.map(Box::new),
            gains,
            states: vec![JointState::new(); n],
            // What is recorded where the supervisor has not been asked yet.
            references: (0..n).map(|i| reference(&motion, i, 0.0)).collect(),
            motion,
            starts: study.interface.kept && study.interface.profile.first_torque_max.is_some(),
            echo: Echo::new(study),
            commands: vec![Command::default(); n],
        })
    }

    /// One control sample at time `t` \[s\]; leaves `references` and `commands`. A controller that does
    /// not run leaves the commands as they are.
    pub(crate) fn step(&mut self, t: f64, sample: &Sample, runs: bool) {
        if let Some(supervised) = &mut self.supervised {
            // The reference waits where the arm does not track; the start rule is the first torque's.
            let first = core::mem::take(&mut self.starts);
            if runs && !first {
                let answer = (&mut self.references[..], &mut self.commands[..]);
                supervised.step(t, sample, &self.motion, answer);
                if let Some(echo) = &mut self.echo {
                    echo.keep(sample, &mut self.commands);
                }
            }
            return;
        }
        for (i, wanted) in self.references.iter_mut().enumerate() {
            *wanted = reference(&self.motion, i, t);
        }
        if !runs || core::mem::take(&mut self.starts) {
            return;
        }
        update_joints(
            &self.gains,
            &mut self.states,
            &sample.joints,
            &self.references,
            &mut self.commands,
        );
        if let Some(echo) = &mut self.echo {
            echo.keep(sample, &mut self.commands);
        }
    }

    /// What the supervisor did at the last sample.
    pub(crate) fn report(&self) -> Option<&Report> {
        self.supervised.as_ref().map(|supervised| &supervised.report)
    }

    /// Nominal inertia of a joint \[kg·m²\].
    pub(crate) fn inertia(&self, joint: usize) -> f64 {
        self.gains[joint].inertia()
    }
}

fn reference(motion: &Motion, joint: usize, t: f64) -> Reference<f64> {
    let [q, dq, ddq] = motion.at(joint, t);
    Reference { q, dq, ddq }
}

fn limited(study: &Study, gains: &[JointGains<f64>]) -> Result<Vec<JointGains<f64>>, SimError> {
    let period = study.control.period_ns as f64 * 1e-9;
    let per = |values: &Option<Vec<f64>>, i: usize| values.as_ref().map(|v| v[i]);
    let with = |(i, gains): (usize, &JointGains<f64>)| {
        let mut torque = per(&study.control.torque_max, i);
        let mut rate = per(&study.control.torque_rate_max, i);
        let Interface { profile, kept } = &*study.interface;
        if *kept {
            let most = study.robot.joints[i].torque_max.filter(|_| profile.clamps_torque);
            torque = smaller(torque, most);
            rate = smaller(rate, profile.torque_rate_max);
        }
        let limits = Limits::new(torque, rate, period)
            .map_err(|e| SimError::Limit(format!("{}: {e}", study.robot.joints[i].name)))?;
        Ok(gains.with_limits(limits))
    };
    gains.iter().enumerate().map(with).collect()
}

/// The smaller of two limits, where there are two.
fn smaller(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}
