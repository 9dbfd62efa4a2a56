//! A torque-rate rule kept although commands get lost.

use phihat::Command;
use phihat_study::Study;

use crate::sample::Sample;

/// Relative rounding of a torque in single precision.
const ROUNDING: f64 = 1e-6;

/// Keeps every command within one step of whatever the robot may have accepted last.
///
/// The robot compares a command with the last one that arrived, not with the last one sent. Its echo says
/// which that was; while no fresh echo comes, it is the last echo or any command sent since. The limit is the
/// intersection of the intervals around all of these, never empty as each was chosen so. An echo of a command
/// that was never sent is ignored: the robot can only have accepted a command that was sent, or the torque
/// that held the arm before. The first echo gives that torque, where a first command could be within one step
/// of it.
#[derive(Debug)]
pub(crate) struct Echo {
    step: f64,
    sequence: Option<u64>,
    /// Least and greatest command that may have been accepted last, per joint.
    possible: Vec<(f64, f64)>,
}

impl Echo {
    /// `None` where there is no rule, or the controller does not keep it.
    pub(crate) fn new(study: &Study) -> Option<Self> {
        let rate = study.interface.profile.torque_rate_max.filter(|_| study.interface.kept)?;
        let period = study.control.period_ns as f64 * 1e-9;
        let joints = study.robot.joints.len();
        Some(Self { step: rate * period, sequence: None, possible: vec![(0.0, 0.0); joints] })
    }

    /// Something holds the arm with these torques \[N·m\] until the first command.
    pub(crate) fn holding(&mut self, held: &[f64]) {
        for (possible, tau) in self.possible.iter_mut().zip(held) {
            *possible = (*tau, *tau);
        }
    }

    /// Limits the commands that answer a sample.
    pub(crate) fn keep(&mut self, sample: &Sample, commands: &mut [Command<f64>]) {
        let (fresh, first) = (self.sequence != Some(sample.sequence), self.sequence.is_none());
        self.sequence = Some(sample.sequence);
        for (i, command) in commands.iter_mut().enumerate() {
            let possible = &mut self.possible[i];
            if fresh {
                let echo = sample.accepted[i];
                let slack = ROUNDING * (1.0 + echo.abs());
                let more = if first { self.step } else { 0.0 } + slack;
                if echo >= possible.0 - more && echo <= possible.1 + more {
                    *possible = (echo, echo);
                }
            }
            let (low, high) = (possible.1 - self.step, possible.0 + self.step);
            if command.tau > high || command.tau < low {
                command.tau = if command.tau > high { high } else { low };
                command.status.rate_limited = true;
            }
        }
    }

    /// These commands were sent: from here on the robot may have accepted them.
    pub(crate) fn sent(&mut self, commands: &[Command<f64>]) {
        for (possible, command) in self.possible.iter_mut().zip(commands) {
            *possible = (possible.0.min(command.tau), possible.1.max(command.tau));
        }
    }
}
