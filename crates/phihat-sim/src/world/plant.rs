//! The arm that answers: rigid bodies, rotor inertia, friction, drives, pushes.

use phihat_model::{Model, Workspace};

use super::drive::Drive;
use super::friction::Friction;
use crate::integrator::{Acceleration, Rk4};

/// A constant external torque on a joint for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Push {
    pub(crate) joint: usize,
    pub(crate) torque: f64,
    pub(crate) start: f64,
    pub(crate) end: f64,
}

/// Everything that turns torque into motion.
///
/// # Law
///
/// ```text
/// M(q) q̈ + C(q, q̇) q̇ + g(q) = τ(t) − τ_f(q̇) + τ_push(t),   M with rotor inertia             (P1)
/// ```
#[derive(Debug)]
pub(crate) struct Forces {
    model: Model,
    workspace: Workspace<f64>,
    friction: Vec<Friction>,
    drives: Vec<Drive>,
    pushes: Vec<Push>,
    /// Start of the current control interval \[s\].
    interval: f64,
    tau: Vec<f64>,
}

impl Acceleration for Forces {
    fn acceleration(&mut self, t: f64, q: &[f64], dq: &[f64], ddq: &mut [f64]) {
        let elapsed = t - self.interval;
        for (i, tau) in self.tau.iter_mut().enumerate() {
            *tau = self.drives[i].torque(elapsed) - self.friction[i].torque(dq[i]);
        }
        for push in &self.pushes {
            if push.start <= t && t < push.end {
                self.tau[push.joint] += push.torque;
            }
        }
        self.model.forward_dynamics(&mut self.workspace, q, dq, &self.tau, ddq);
    }
}

/// The plant and its state.
#[derive(Debug)]
pub(crate) struct Plant {
    forces: Forces,
    rk4: Rk4,
    pub(crate) q: Vec<f64>,
    pub(crate) dq: Vec<f64>,
    /// `q̈` at the start of the last interval.
    pub(crate) ddq: Vec<f64>,
    /// Torque at the start of the last interval \[N·m\].
    pub(crate) tau_start: Vec<f64>,
    /// Mean torque over the last interval \[N·m\].
    pub(crate) tau_mean: Vec<f64>,
    discarded: Vec<f64>,
}

impl Plant {
    pub(crate) fn new(
        model: Model,
        friction: Vec<Friction>,
        bandwidths_hz: &[Option<f64>],
        pushes: Vec<Push>,
        (q, dq): (Vec<f64>, Vec<f64>),
    ) -> Self {
        let n = q.len();
        let zero = vec![0.0; n];
        let forces = Forces {
            workspace: Workspace::new(&model),
            model,
            friction,
            drives: bandwidths_hz.iter().map(|hz| Drive::new(*hz)).collect(),
            pushes,
            interval: 0.0,
            tau: zero.clone(),
        };
        Self {
            forces,
            rk4: Rk4::new(n),
            q,
            dq,
            ddq: zero.clone(),
            tau_start: zero.clone(),
            tau_mean: zero.clone(),
            discarded: zero,
        }
    }

    /// Holds a torque demand from `t` for `period`, in `substeps` RK4 steps.
    pub(crate) fn advance(&mut self, t: f64, period: f64, substeps: u32, demand: &[f64]) {
        self.forces.interval = t;
        for (i, drive) in self.forces.drives.iter_mut().enumerate() {
            drive.demand(demand[i]);
            self.tau_start[i] = drive.torque(0.0);
        }
        let h = period / f64::from(substeps);
        for step in 0..substeps {
            let first = if step == 0 { &mut self.ddq } else { &mut self.discarded };
            let start = t + f64::from(step) * h;
            self.rk4.step(&mut self.forces, (start, h), &mut self.q, &mut self.dq, first);
        }
        for (i, drive) in self.forces.drives.iter_mut().enumerate() {
            self.tau_mean[i] = drive.finish(period);
        }
    }

    /// RK4 steps per `period` that friction's stiffness asks for at this pose, and the joint that asks.
    ///
    /// `λ = (dτ_f/dv)/J`, `J = 1/(M⁻¹)_ii`; RK4 is stable for `λ h < 2.78`, used up to 2.
    pub(crate) fn steps_needed(&mut self, period: f64) -> (u32, usize) {
        let n = self.q.len();
        let mut worst = (1, 0);
        let rest = vec![0.0; n];
        let mut bias = vec![0.0; n];
        let mut ddq = vec![0.0; n];
        let forces = &mut self.forces;
        forces.model.forward_dynamics(&mut forces.workspace, &self.q, &rest, &rest, &mut bias);
        for i in 0..n {
            let mut unit = rest.clone();
            unit[i] = 1.0;
            forces.model.forward_dynamics(&mut forces.workspace, &self.q, &rest, &unit, &mut ddq);
            let rate = forces.friction[i].stiffness() * (ddq[i] - bias[i]);
            let needed = (rate * period / 2.0).ceil();
            if needed > f64::from(worst.0) {
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a positive whole number; saturates far beyond what a study may ask"
                )]
                let count = needed as u32;
                worst = (count, i);
            }
        }
        worst
    }
}
