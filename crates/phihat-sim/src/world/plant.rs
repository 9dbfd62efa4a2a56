//! The arm that answers: rigid bodies, rotor inertia, friction, drives, pushes.

use phihat_study::Fault;

use super::drive::Drive;
use super::friction::Friction;
use super::payload::Carried;
use super::shape::Shape;
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
    carried: Carried,
    friction: Vec<Friction>,
    drives: Vec<Drive>,
    shapes: Option<Vec<Shape>>,
    pushes: Vec<Push>,
    /// Start of the current control interval \[s\].
    interval: f64,
    tau: Vec<f64>,
    /// What shaped drives gave beyond what they meant to, summed with the integrator's weights, and how
    /// often.
    excess: Vec<f64>,
    stage: usize,
}

/// Weights of the four stages of RK4.
const STAGES: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

impl Acceleration for Forces {
    fn acceleration(&mut self, t: f64, q: &[f64], dq: &[f64], ddq: &mut [f64]) {
        let elapsed = t - self.interval;
        match &self.shapes {
            None => {
                for (i, tau) in self.tau.iter_mut().enumerate() {
                    *tau = self.drives[i].torque(elapsed) - self.friction[i].torque(dq[i]);
                }
            }
            Some(shapes) => {
                let weight = STAGES[self.stage % 4];
                self.stage += 1;
                for (i, tau) in self.tau.iter_mut().enumerate() {
                    let meant = self.drives[i].torque(elapsed);
                    let given = shapes[i].torque(meant, t, q[i], dq[i]);
                    self.excess[i] += weight * (given - meant);
                    *tau = given - self.friction[i].torque(dq[i]);
                }
            }
        }
        for push in &self.pushes {
            if push.start <= t && t < push.end {
                self.tau[push.joint] += push.torque;
            }
        }
        let (model, workspace) = self.carried.model();
        model.forward_dynamics(workspace, q, dq, &self.tau, ddq);
    }
}

/// What a plant is made of.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) carried: Carried,
    pub(super) friction: Vec<Friction>,
    pub(super) drives: Vec<Drive>,
    pub(super) shapes: Option<Vec<Shape>>,
    pub(super) pushes: Vec<Push>,
    /// Those that act on drives and friction.
    pub(super) faults: Vec<Fault>,
}

/// The plant and its state.
#[derive(Debug)]
pub(crate) struct Plant {
    forces: Forces,
    rk4: Rk4,
    faults: Vec<Fault>,
    /// Friction without faults.
    healthy: Vec<Friction>,
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
    pub(super) fn new(parts: Parts, (q, dq): (Vec<f64>, Vec<f64>)) -> Self {
        let n = q.len();
        let zero = vec![0.0; n];
        let forces = Forces {
            carried: parts.carried,
            friction: parts.friction.clone(),
            drives: parts.drives,
            shapes: parts.shapes,
            pushes: parts.pushes,
            interval: 0.0,
            tau: zero.clone(),
            excess: zero.clone(),
            stage: 0,
        };
        Self {
            forces,
            rk4: Rk4::new(n),
            faults: parts.faults,
            healthy: parts.friction,
            q,
            dq,
            ddq: zero.clone(),
            tau_start: zero.clone(),
            tau_mean: zero.clone(),
            discarded: zero,
        }
    }

    /// Lets the faults of time `t` \[s\] act on drives and friction.
    fn fault(&mut self, t: f64) {
        for i in 0..self.q.len() {
            self.forces.friction[i] = self.healthy[i].faulty(&self.faults, i, |f| f.active(t));
            if let Some(shapes) = &mut self.forces.shapes {
                shapes[i].fault(&self.faults, i, t);
            }
        }
    }

    /// Holds a torque demand from `t` for `period`, in `substeps` RK4 steps.
    pub(crate) fn advance(&mut self, t: f64, period: f64, substeps: u32, demand: &[f64]) {
        self.forces.interval = t;
        self.forces.carried.go_to(t);
        if !self.faults.is_empty() {
            self.fault(t);
        }
        for (i, drive) in self.forces.drives.iter_mut().enumerate() {
            drive.demand(demand[i]);
            self.tau_start[i] = drive.torque(0.0);
        }
        if let Some(shapes) = &self.forces.shapes {
            for (i, shape) in shapes.iter().enumerate() {
                self.tau_start[i] = shape.torque(self.tau_start[i], t, self.q[i], self.dq[i]);
                self.forces.excess[i] = 0.0;
            }
            self.forces.stage = 0;
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
        if self.forces.shapes.is_some() {
            for (mean, excess) in self.tau_mean.iter_mut().zip(&self.forces.excess) {
                *mean += excess / f64::from(substeps);
            }
        }
    }

    /// Takes what the robot added by itself out of the last interval's torques: the controller knows
    /// nothing of it, and `φ` lacks it.
    pub(super) fn deduct(&mut self, added: &[f64]) {
        for (i, added) in added.iter().enumerate() {
            self.tau_start[i] -= added;
            self.tau_mean[i] -= added;
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
        let (model, workspace) = forces.carried.model();
        model.forward_dynamics(workspace, &self.q, &rest, &rest, &mut bias);
        for i in 0..n {
            let mut unit = rest.clone();
            unit[i] = 1.0;
            model.forward_dynamics(workspace, &self.q, &rest, &unit, &mut ddq);
            let worst_friction = self.healthy[i].worst(&self.faults, i);
            let rate = worst_friction.stiffness() * (ddq[i] - bias[i]);
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
