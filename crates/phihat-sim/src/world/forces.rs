//! From torques and forces to accelerations.

use super::bristle::Bristle;
use super::contact::Contacts;
use super::drive::DriveLoop;
use super::friction::SimulatedFriction;
use super::payload::Carried;
use super::shape::DriveImperfections;
use super::spring::{EndStop, Transmission};
use crate::integrator::AccelerationOf;

/// A constant external torque on a joint for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PushForce {
    pub(super) joint: usize,
    pub(super) torque: f64,
    pub(super) start: f64,
    pub(super) end: f64,
}

/// Everything that turns torque into motion.
///
/// # Law
///
/// ```text
/// M(q) q̈ + C(q, q̇) q̇ + g(q) = τ(t) − τ_f(q̇) + τ_push(t) + τ_stop + Jᵀ f,  M with rotor inertia   (PL1)
/// ```
///
/// With elastic transmissions the state is `[q; θ]`, links before rotors, `M` has no rotor inertia, and
///
/// ```text
/// B θ̈ = τ − τ_f(θ̇) − τ_s,   τ_s = k (θ − q) + d (θ̇ − q̇),   with τ_s in place of τ − τ_f in (PL1)     (PL2)
/// ```
#[derive(Debug)]
pub(super) struct Forces {
    pub(super) carried: Carried,
    pub(super) friction: Vec<SimulatedFriction>,
    pub(super) bristles: Option<Vec<Bristle>>,
    pub(super) drives: Vec<DriveLoop>,
    pub(super) shapes: Option<Vec<DriveImperfections>>,
    pub(super) transmissions: Option<Vec<Transmission>>,
    pub(super) stops: Option<Vec<EndStop>>,
    pub(super) contacts: Option<Contacts>,
    pub(super) pushes: Vec<PushForce>,
    /// Start of the current control interval and of the current step \[s\].
    pub(super) interval: f64,
    pub(super) step: f64,
    pub(super) tau: Vec<f64>,
    /// Torque of shaped drives beyond the demanded one, summed with the integrator's weights \[N·m\], and the
    /// number of evaluations.
    pub(super) excess: Vec<f64>,
    pub(super) stage: usize,
}

/// Weights of the four stages of RK4.
pub(super) const STAGES: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

impl AccelerationOf for Forces {
    fn acceleration(&mut self, t: f64, q: &[f64], dq: &[f64], ddq: &mut [f64]) {
        let n = self.tau.len();
        let (link, link_speed) = (&q[..n], &dq[..n]);
        // Drives and friction act on the rotor, which is the link where nothing is elastic.
        let (rotor, rotor_speed) = (&q[q.len() - n..], &dq[q.len() - n..]);
        self.drive(t, rotor, rotor_speed);
        if let Some(transmissions) = &self.transmissions {
            for (i, spring) in transmissions.iter().enumerate() {
                let passed = spring.torque(rotor[i] - link[i], rotor_speed[i] - link_speed[i]);
                ddq[n + i] = (self.tau[i] - passed) / spring.rotor;
                self.tau[i] = passed;
            }
        }
        for push in &self.pushes {
            // Held over a step: a force that begins with a sample begins there exactly.
            if push.start <= self.step && self.step < push.end {
                self.tau[push.joint] += push.torque;
            }
        }
        if let Some(stops) = &self.stops {
            for (i, stop) in stops.iter().enumerate() {
                self.tau[i] += stop.torque(link[i], link_speed[i]);
            }
        }
        if let Some(contacts) = &mut self.contacts {
            contacts.add(self.carried.model(), self.step, (link, link_speed), &mut self.tau);
        }
        let (model, workspace) = self.carried.model();
        model.forward_dynamics(workspace, link, link_speed, &self.tau, &mut ddq[..n]);
    }
}

impl Forces {
    /// Torque of drives and friction at time `t`.
    fn drive(&mut self, t: f64, q: &[f64], dq: &[f64]) {
        let elapsed = t - self.interval;
        match &self.shapes {
            None => {
                for (tau, drive) in self.tau.iter_mut().zip(&self.drives) {
                    *tau = drive.torque(elapsed);
                }
            }
            Some(shapes) => {
                let weight = STAGES[self.stage % 4];
                self.stage += 1;
                for (i, tau) in self.tau.iter_mut().enumerate() {
                    let meant = self.drives[i].torque(elapsed);
                    *tau = shapes[i].torque(meant, t, q[i], dq[i]);
                    self.excess[i] += weight * (*tau - meant);
                }
            }
        }
        match &self.bristles {
            None => {
                for (i, tau) in self.tau.iter_mut().enumerate() {
                    *tau -= self.friction[i].torque(dq[i]);
                }
            }
            Some(bristles) => {
                let elapsed = t - self.step;
                for (i, tau) in self.tau.iter_mut().enumerate() {
                    let friction = &self.friction[i];
                    *tau -= friction.smooth(dq[i]);
                    *tau -= bristles[i].torque(dq[i], friction.coulomb, elapsed);
                }
            }
        }
    }

    /// Begins an integration step at time `t`, velocity `dq`.
    pub(super) fn begin(&mut self, t: f64, dq: &[f64]) {
        self.step = t;
        let Some(bristles) = &mut self.bristles else { return };
        let rotor_speed = &dq[dq.len() - bristles.len()..];
        bristles.iter_mut().zip(rotor_speed).for_each(|(bristle, v)| bristle.begin(*v));
    }

    /// Ends it, `h` seconds later.
    pub(super) fn end(&mut self, h: f64, dq: &[f64]) {
        let Some(bristles) = &mut self.bristles else { return };
        let rotor_speed = &dq[dq.len() - bristles.len()..];
        for ((bristle, v), friction) in bristles.iter_mut().zip(rotor_speed).zip(&self.friction) {
            bristle.end(*v, friction.coulomb, h);
        }
    }
}
