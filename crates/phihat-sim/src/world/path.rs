//! The way of a command from the controller to the drives.

use phihat::{DELAY_MAX, Delay};
use phihat_study::{Fault, FaultKind, Study};

use super::firmware::{Abort, Firmware};
use super::loss::{LossRows, MessageLoss};
use super::noise::NoiseEffect;
use crate::error::SimError;

/// Commands that get lost (the drives keep the last one), the robot's interface, and transport delay.
#[derive(Debug)]
pub(crate) struct CommandPath {
    delays: Vec<Delay<f64>>,
    late: usize,
    loss: Option<MessageLoss>,
    rows: Option<LossRows>,
    stops: Vec<Fault>,
    /// Last sample whose loss was drawn, and true if its command gets through.
    drawn: Option<(u64, bool)>,
    firmware: Option<Firmware>,
    /// Set once the robot has stopped.
    pub(crate) abort: Option<Abort>,
    arrived: Vec<f64>,
    /// Last command that got through.
    pub(crate) sent: Vec<f64>,
    /// Torque delivered to the drives over the current interval \[N·m\].
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
        let kinds =
            (FaultKind::CommandLoss, NoiseEffect::CommandLoss, NoiseEffect::FaultCommandLoss);
        let stop = |fault: &&Fault| fault.kind == FaultKind::ControllerStop;
        Ok(Self {
            delays: vec![delay; zero.len()],
            late: study.control.delay_samples as usize,
            loss: MessageLoss::new(study.world.network.command, &study.faults, kinds, study.seed),
            rows: study.world.network.rows.map(|rows| LossRows::new(rows, study)),
            stops: study.faults.iter().filter(stop).cloned().collect(),
            drawn: None,
            firmware: Firmware::new(study),
            abort: None,
            sent: zero.clone(),
            arrived: zero.clone(),
            told: zero.clone(),
            told_max: zero.clone(),
            step_max: zero,
        })
    }

    /// Takes the faults of a study that is this one's own but for them.
    pub(super) fn meet(&mut self, study: &Study) {
        let kinds =
            (FaultKind::CommandLoss, NoiseEffect::CommandLoss, NoiseEffect::FaultCommandLoss);
        let loss = MessageLoss::new(study.world.network.command, &study.faults, kinds, study.seed);
        self.loss = loss.map(|loss| loss.after(self.loss.as_ref()));
        let stop = |fault: &&Fault| fault.kind == FaultKind::ControllerStop;
        self.stops = study.faults.iter().filter(stop).cloned().collect();
    }

    /// As if so much torque per joint had been sent for long.
    pub(super) fn held(&mut self, torque: &[f64]) {
        for (i, torque) in torque.iter().enumerate() {
            for _ in 0..DELAY_MAX {
                self.delays[i].pass(*torque);
            }
            self.sent[i] = *torque;
            self.told[i] = *torque;
        }
    }

    /// Returns true if commands are late at most: neither lost, nor stopped, nor checked by a robot's
    /// interface.
    pub(super) fn uneventful(&self) -> bool {
        self.loss.is_none()
            && self.rows.is_none()
            && self.stops.is_empty()
            && self.firmware.is_none()
    }

    /// Samples by which a command is late.
    pub(super) fn late(&self) -> usize {
        self.late
    }

    /// Returns true if the controller runs at time `t` \[s\].
    pub(crate) fn controller_runs(&self, t: f64) -> bool {
        !self.stops.iter().any(|stop| stop.active(t))
    }

    /// Returns true if the command of sample `k`, at time `t` \[s\], gets through. The first one opens the
    /// session: it is sent until it arrives.
    pub(crate) fn arrives(&mut self, k: u64, t: f64) -> bool {
        if let Some((_, arrives)) = self.drawn.filter(|(at, _)| *at == k) {
            return arrives;
        }
        let lost = self.loss.as_mut().is_some_and(|loss| loss.lost(k, t)) && k > 0;
        let row = self.rows.as_mut().is_some_and(|rows| rows.lost(k));
        let arrives = !lost && !row && self.controller_runs(t);
        self.drawn = Some((k, arrives));
        arrives
    }

    /// Takes the command of sample `k`; leaves `told`.
    pub(super) fn pass(&mut self, k: u64, t: f64, torque: impl Iterator<Item = f64>) {
        let arrives = self.arrives(k, t);
        match &mut self.firmware {
            _ if self.abort.is_some() => {}
            None if arrives => {
                self.sent.iter_mut().zip(torque).for_each(|(sent, torque)| *sent = torque);
            }
            None => {}
            Some(firmware) => {
                self.arrived.clear();
                self.arrived.extend(torque);
                match firmware.receive(t, arrives.then_some(&mut self.arrived)) {
                    Ok(()) if arrives => self.sent.copy_from_slice(&self.arrived),
                    Ok(()) => {}
                    Err(abort) => self.abort = Some(abort),
                }
            }
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

impl CommandPath {
    /// Torque that the robot adds to `told` at a state of the arm \[N·m\], if it adds anything.
    pub(super) fn added(&mut self, q: &[f64], dq: &[f64]) -> Option<&[f64]> {
        let firmware = self.firmware.as_mut()?;
        firmware.add(q, dq);
        Some(&firmware.added)
    }
}

/// The larger one; not a number, if either is not.
fn larger(a: f64, b: f64) -> f64 {
    if b <= a || a.is_nan() { a } else { b }
}
