//! The robot's torque interface: what it adds to a command, and on what it stops.

use phihat_model::{Model, Profile, Workspace};
use phihat_study::Study;
use thiserror::Error;

use super::build::frictions_of_robot;
use super::friction::SimulatedFriction;

/// Slack of a rule \[relative\], for rounding.
const ROUNDING: f64 = 1e-9;

/// A robot that stopped, when and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Abort {
    /// When \[s\].
    pub t: f64,
    /// The interface that stopped.
    pub interface: String,
    /// The joint it was about, if it was about one.
    pub joint: Option<String>,
    /// Why, with the figure and the limit.
    pub reason: StopReason,
}

/// Why a robot's torque interface stopped.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum StopReason {
    /// A command that is no number \[N·m\].
    #[error("a torque of {0} N·m")]
    NotFinite(f64),
    /// A first command above what the interface takes \[N·m\].
    #[error("a first torque of {torque:.3} N·m, at most {most} is allowed")]
    FirstTorque {
        /// The command.
        torque: f64,
        /// The largest that is taken.
        most: f64,
    },
    /// A change of the command above what the interface takes \[N·m per sample\].
    #[error("the torque changed by {step:.3} N·m in one sample, at most {most} is allowed")]
    TorqueRate {
        /// The change.
        step: f64,
        /// The largest that is taken.
        most: f64,
    },
    /// Too many samples in a row without a command.
    #[error("{losses} commands in a row were lost, {most} stop it")]
    Lost {
        /// Number of lost commands in a row.
        losses: u32,
        /// Number of lost commands that stops the robot.
        most: u32,
    },
    /// Stop of a real robot, or of one served to a client: the reason, by the name that its interface has for
    /// it.
    #[error("{0}")]
    Robot(&'static str),
}

/// The interface's state. It sees commands as they arrive, before the transport delay.
#[derive(Debug)]
pub(super) struct Firmware {
    profile: Profile,
    names: Vec<String>,
    torque_max: Vec<f64>,
    period: f64,
    /// The last command that arrived, and that before the filter.
    accepted: Vec<f64>,
    filtered: Vec<f64>,
    /// `1 − e^{−2πfT}`; 1 without a filter.
    filter: f64,
    started: bool,
    losses: u32,
    rest: Vec<f64>,
    gravity: Option<(Model, Workspace<f64>)>,
    friction: Vec<SimulatedFriction>,
    /// Torque that the robot adds over the current interval \[N·m\].
    pub(super) added: Vec<f64>,
}

impl Firmware {
    /// `None` for ideal drives.
    pub(super) fn new(study: &Study) -> Option<Self> {
        let profile = study.interface.profile.clone();
        let bare = Profile {
            name: profile.name.clone(),
            description: profile.description.clone(),
            source: profile.source.clone(),
            rate_min: profile.rate_min,
            rate_max: profile.rate_max,
            adds_gravity: false,
            adds_friction: 0.0,
            clamps_torque: false,
            torque_rate_max: None,
            first_torque_max: None,
            losses_max: None,
            torque_filter: None,
        };
        if profile == bare {
            return None;
        }
        let zero = vec![0.0; study.robot.joints.len()];
        let limit = |joint: &phihat_model::Joint| match joint.torque_max {
            Some(limit) if profile.clamps_torque => limit,
            _ => f64::INFINITY,
        };
        let model = study.robot.plant_model().with_gravity(study.world.gravity);
        let workspace = Workspace::new(&model);
        let period = study.control.period_ns as f64 * 1e-9;
        let pole = |f: f64| -libm::expm1(-core::f64::consts::TAU * f * period);
        Some(Self {
            names: study.robot.joint_names(),
            torque_max: study.robot.joints.iter().map(limit).collect(),
            period,
            accepted: zero.clone(),
            filtered: zero.clone(),
            filter: profile.torque_filter.map_or(1.0, pole),
            started: false,
            losses: 0,
            gravity: profile.adds_gravity.then_some((model, workspace)),
            friction: if profile.adds_friction > 0.0 {
                frictions_of_robot(study)
            } else {
                vec![SimulatedFriction::default(); zero.len()]
            },
            rest: zero.clone(),
            added: zero,
            profile,
        })
    }

    /// Takes the command of time `t` \[s\], or none; changes it to what the drives shall give.
    pub(super) fn receive(&mut self, t: f64, command: Option<&mut [f64]>) -> Result<(), Abort> {
        let Some(command) = command else { return self.lose(t) };
        self.losses = 0;
        for i in 0..command.len() {
            self.check(i, command[i]).map_err(|reason| self.abort(t, Some(i), reason))?;
        }
        self.started = true;
        self.accepted.copy_from_slice(command);
        for (i, command) in command.iter_mut().enumerate() {
            let limit = self.torque_max[i];
            let clamped = command.clamp(-limit, limit);
            if self.filter < 1.0 {
                self.filtered[i] += self.filter * (clamped - self.filtered[i]);
                *command = self.filtered[i];
            } else {
                *command = clamped;
            }
        }
        Ok(())
    }

    fn lose(&mut self, t: f64) -> Result<(), Abort> {
        self.losses += 1;
        match self.profile.losses_max {
            Some(most) if self.losses >= most => {
                let reason = StopReason::Lost { losses: self.losses, most };
                Err(self.abort(t, None, reason))
            }
            _ => Ok(()),
        }
    }

    fn check(&self, i: usize, command: f64) -> Result<(), StopReason> {
        if !command.is_finite() {
            return Err(StopReason::NotFinite(command));
        }
        if let Some(most) = self.profile.first_torque_max.filter(|_| !self.started)
            && command.abs() > most
        {
            return Err(StopReason::FirstTorque { torque: command, most });
        }
        if let Some(rate) = self.profile.torque_rate_max {
            let (most, step) = (rate * self.period, (command - self.accepted[i]).abs());
            if step > most * (1.0 + ROUNDING) {
                return Err(StopReason::TorqueRate { step, most });
            }
        }
        Ok(())
    }

    fn abort(&self, t: f64, joint: Option<usize>, reason: StopReason) -> Abort {
        let joint = joint.map(|i| self.names[i].clone());
        Abort { t, interface: self.profile.name.clone(), joint, reason }
    }

    /// Computes what is added at a state of the arm.
    pub(super) fn add(&mut self, q: &[f64], dq: &[f64]) {
        self.added.fill(0.0);
        if let Some((model, workspace)) = &mut self.gravity {
            model.bias(workspace, q, &self.rest, &mut self.added);
        }
        for (i, added) in self.added.iter_mut().enumerate() {
            *added += self.profile.adds_friction * self.friction[i].torque(dq[i]);
        }
    }
}
