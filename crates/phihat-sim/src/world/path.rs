//! The way of a command from the controller to the drives.

use phihat::Delay;
use phihat_study::{Fault, FaultKind, Study};

use super::loss::Loss;
use super::noise::Effect;
use crate::error::SimError;

/// Transport delay, and commands that get lost; the drives keep the last one.
#[derive(Debug)]
pub(crate) struct CommandPath {
    delays: Vec<Delay<f64>>,
    loss: Option<Loss>,
    stops: Vec<Fault>,
    /// What was last sent and got through.
    sent: Vec<f64>,
    /// What the drives are told over the current interval \[N·m\].
    pub(crate) told: Vec<f64>,
    /// Largest of it so far, and largest change from one sample to the next \[N·m\].
    pub(crate) told_max: Vec<f64>,
    pub(crate) step_max: Vec<f64>,
}

impl CommandPath {
    pub(super) fn new(study: &Study) -> Result<Self, SimError> {
        let zero = vec![0.0; study.robot.joints.len()];
        let delay = Delay::new(study.control.delay_samples as usize)
            .map_err(|e| SimError::Limit(e.to_string()))?;
        let kinds = (FaultKind::CommandLoss, Effect::CommandLoss, Effect::FaultCommandLoss);
        let stop = |fault: &&Fault| fault.kind == FaultKind::ControllerStop;
        Ok(Self {
            delays: vec![delay; zero.len()],
            loss: Loss::new(study.world.network.command, &study.faults, kinds, study.seed),
            stops: study.faults.iter().filter(stop).cloned().collect(),
            sent: zero.clone(),
            told: zero.clone(),
            told_max: zero.clone(),
            step_max: zero,
        })
    }

    /// Whether the controller runs at time `t` \[s\].
    pub(crate) fn controller_runs(&self, t: f64) -> bool {
        !self.stops.iter().any(|stop| stop.active(t))
    }

    /// Takes the command of sample `k`; leaves `told`.
    pub(super) fn pass(&mut self, k: u64, t: f64, torque: impl Iterator<Item = f64>) {
        let lost = self.loss.as_mut().is_some_and(|loss| loss.lost(k, t));
        if !lost && self.controller_runs(t) {
            self.sent.iter_mut().zip(torque).for_each(|(sent, torque)| *sent = torque);
        }
        for i in 0..self.sent.len() {
            let told = self.delays[i].pass(self.sent[i]);
            let step = (told - self.told[i]).abs();
            self.told[i] = told;
            self.told_max[i] = larger(self.told_max[i], told.abs());
            self.step_max[i] = larger(self.step_max[i], step);
        }
    }
}

/// The larger one; not a number, if either is not.
fn larger(a: f64, b: f64) -> f64 {
    if b <= a || a.is_nan() { a } else { b }
}
