//! The arm that answers: its state, and how it goes on.

use core::mem;

use phihat_study::Fault;

use super::bristle::Bristle;
use super::contact::Contacts;
use super::drive::DriveLoop;
use super::forces::{Forces, PushForce};
use super::friction::SimulatedFriction;
use super::payload::Carried;
use super::shape::DriveImperfections;
use super::spring::{EndStop, Transmission};
use crate::integrator::Rk4;

/// Parts of a plant.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) carried: Carried,
    pub(super) friction: Vec<SimulatedFriction>,
    pub(super) bristles: Option<Vec<Bristle>>,
    pub(super) drives: Vec<DriveLoop>,
    pub(super) shapes: Option<Vec<DriveImperfections>>,
    pub(super) transmissions: Option<Vec<Transmission>>,
    pub(super) stops: Option<Vec<EndStop>>,
    pub(super) contacts: Option<Contacts>,
    pub(super) pushes: Vec<PushForce>,
    /// Those that act on drives and friction.
    pub(super) faults: Vec<Fault>,
    /// Friction of a cold joint over that of a warm one, and the time constant between \[s\].
    pub(super) warm_up: Option<(f64, f64)>,
}

/// Parts of a plant that faults change.
#[derive(Debug)]
pub(super) struct FaultedParts {
    pub(super) carried: Carried,
    pub(super) pushes: Vec<PushForce>,
    pub(super) faults: Vec<Fault>,
    pub(super) shapes: Option<Vec<DriveImperfections>>,
}

/// The plant and its state.
#[derive(Debug)]
pub(crate) struct Plant {
    pub(super) forces: Forces,
    rk4: Rk4,
    pub(super) faults: Vec<Fault>,
    pub(super) warm_up: Option<(f64, f64)>,
    /// Friction without faults.
    pub(super) healthy: Vec<SimulatedFriction>,
    /// Positions of the links; with elastic transmissions, those of the rotors after them.
    pub(crate) q: Vec<f64>,
    /// Likewise velocities.
    pub(crate) dq: Vec<f64>,
    /// `q̈` at the start of the last interval, likewise.
    pub(crate) ddq: Vec<f64>,
    /// Torque at the start of the last interval \[N·m\].
    pub(crate) tau_start: Vec<f64>,
    /// Mean torque over the last interval \[N·m\].
    pub(crate) tau_mean: Vec<f64>,
    discarded: Vec<f64>,
}

impl Plant {
    /// Returns true if the plant does not change: neither load nor friction changes with time.
    pub(super) fn lasting(&self) -> bool {
        self.faults.is_empty() && self.warm_up.is_none() && self.forces.carried.lasts()
    }

    /// Starts at the links' positions and velocities; elastic transmissions start as bent as gravity has
    /// them.
    pub(super) fn new(parts: Parts, (mut q, mut dq): (Vec<f64>, Vec<f64>)) -> Self {
        let n = q.len();
        let zero = vec![0.0; n];
        let mut carried = parts.carried;
        if let Some(transmissions) = &parts.transmissions {
            let mut gravity = zero.clone();
            let (model, workspace) = carried.model();
            model.bias(workspace, &q, &zero, &mut gravity);
            let rotors = q.iter().zip(transmissions).zip(&gravity);
            let rotors: Vec<f64> =
                rotors.map(|((q, spring), tau)| q + spring.twist(*tau)).collect();
            q.extend(rotors);
            dq.extend_from_within(..);
        }
        let state = vec![0.0; q.len()];
        let forces = Forces {
            carried,
            friction: parts.friction.clone(),
            bristles: parts.bristles,
            drives: parts.drives,
            shapes: parts.shapes,
            transmissions: parts.transmissions,
            stops: parts.stops,
            contacts: parts.contacts,
            pushes: parts.pushes,
            interval: 0.0,
            step: 0.0,
            tau: zero.clone(),
            excess: zero.clone(),
            stage: 0,
        };
        Self {
            forces,
            rk4: Rk4::new(q.len()),
            faults: parts.faults,
            warm_up: parts.warm_up,
            healthy: parts.friction,
            q,
            dq,
            ddq: state.clone(),
            tau_start: zero.clone(),
            tau_mean: zero,
            discarded: state,
        }
    }

    /// Meets other faults from now on; with what it met before.
    pub(super) fn met(&mut self, next: FaultedParts) -> FaultedParts {
        FaultedParts {
            carried: mem::replace(&mut self.forces.carried, next.carried),
            pushes: mem::replace(&mut self.forces.pushes, next.pushes),
            faults: mem::replace(&mut self.faults, next.faults),
            shapes: mem::replace(&mut self.forces.shapes, next.shapes),
        }
    }

    /// As if the drives had given so much torque for long.
    pub(super) fn held(&mut self, torque: &[f64]) {
        self.tau_mean.copy_from_slice(torque);
        for (drive, torque) in self.forces.drives.iter_mut().zip(torque) {
            *drive = drive.held(*torque);
        }
    }

    /// Lets faults and temperature of time `t` \[s\] act on drives and friction.
    fn change(&mut self, t: f64) {
        let warmth =
            self.warm_up.map_or(1.0, |(cold, time)| 1.0 + (cold - 1.0) * libm::exp(-t / time));
        for (i, friction) in self.forces.friction.iter_mut().enumerate() {
            let warm = self.healthy[i].times(warmth);
            *friction = warm.faulty(&self.faults, i, |fault| fault.active(t));
            if let Some(shapes) = &mut self.forces.shapes {
                shapes[i].fault(&self.faults, i, t);
            }
        }
    }

    /// Begins an interval at `t` with a torque demand that is held over it.
    pub(super) fn begin(&mut self, t: f64, demand: &[f64]) {
        self.forces.interval = t;
        self.forces.carried.go_to(t);
        if !self.faults.is_empty() || self.warm_up.is_some() {
            self.change(t);
        }
        for (i, drive) in self.forces.drives.iter_mut().enumerate() {
            drive.demand(demand[i]);
            self.tau_start[i] = drive.torque(0.0);
        }
        if let Some(shapes) = &self.forces.shapes {
            let rotors = self.q.len() - shapes.len();
            for (i, shape) in shapes.iter().enumerate() {
                let (q, dq) = (self.q[rotors + i], self.dq[rotors + i]);
                self.tau_start[i] = shape.torque(self.tau_start[i], t, q, dq);
                self.forces.excess[i] = 0.0;
            }
            self.forces.stage = 0;
        }
    }

    /// Goes through the interval that begins at `t`, in `substeps` RK4 steps.
    pub(super) fn integrate(&mut self, t: f64, period: f64, substeps: u32) {
        let h = period / f64::from(substeps);
        for step in 0..substeps {
            let first = if step == 0 { &mut self.ddq } else { &mut self.discarded };
            let start = t + f64::from(step) * h;
            self.forces.begin(start, &self.dq);
            self.rk4.step(&mut self.forces, (start, h), &mut self.q, &mut self.dq, first);
            self.forces.end(h, &self.dq);
        }
    }

    /// Goes through an interval in which brakes hold the arm.
    pub(super) fn stand(&mut self) {
        self.dq.fill(0.0);
        self.ddq.fill(0.0);
    }

    /// Ends the interval: the mean of its torques.
    pub(super) fn finish(&mut self, period: f64, substeps: u32) {
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
}
