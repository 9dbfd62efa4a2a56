//! Torque of an imperfect drive for a demanded torque.

use phihat_study::{Fault, Study};

use super::fault::{Acts, DriveFault};
use super::noise::{Noise, NoiseEffect};

/// One joint's imperfections.
///
/// # Law
///
/// ```text
/// τ = g(1 + d t) τ_told (1 + r sin nq) + c sin nq                                              (D2)
/// |τ| ≤ τ_max,   and along the motion |τ| ≤ τ_max (1 − |q̇|/v_0)                                (D3)
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DriveImperfections {
    pub(super) gain: f64,
    pub(super) drift: f64,
    pub(super) ripple: f64,
    pub(super) cogging: f64,
    pub(super) per_turn: f64,
    pub(super) max: f64,
    pub(super) no_load_speed: f64,
    /// Gain and limit of the faults that act.
    pub(super) fault_gain: f64,
    pub(super) fault_max: f64,
}

impl DriveImperfections {
    /// That of a drive that gives what it means to.
    pub(super) const PERFECT: Self = Self {
        gain: 1.0,
        drift: 0.0,
        ripple: 0.0,
        cogging: 0.0,
        per_turn: 0.0,
        max: f64::INFINITY,
        no_load_speed: f64::INFINITY,
        fault_gain: 1.0,
        fault_max: f64::INFINITY,
    };

    /// One per joint; `None` where all drives are perfect.
    pub(super) fn all(study: &Study) -> Option<Vec<Self>> {
        let faulty = study.faults.iter().any(|f| matches!(Acts::of(f.kind), Acts::Drive(_)));
        if study.world.drive.is_none() && !faulty {
            return None;
        }
        Some((0..study.robot.joints.len()).map(|i| Self::new(study, i)).collect())
    }

    fn new(study: &Study, i: usize) -> Self {
        let mut shape = Self::PERFECT;
        if let Some(drive) = &study.world.drive {
            let drawn = Noise::new(study.seed, NoiseEffect::Gain, i).uniform(0);
            let limit = |v: &Option<Vec<f64>>| v.as_ref().map_or(f64::INFINITY, |v| v[i]);
            shape.gain = drive.gain[i] * (1.0 + drive.gain_error[i] * (2.0 * drawn - 1.0));
            shape.drift = drive.gain_drift[i];
            shape.ripple = drive.ripple[i];
            shape.cogging = drive.cogging[i];
            shape.per_turn = f64::from(drive.ripple_per_turn[i]);
            shape.max = limit(&drive.torque_max);
            shape.no_load_speed = limit(&drive.no_load_speed);
        }
        shape
    }

    /// Takes over what the faults of joint `i` say at time `t` \[s\].
    pub(super) fn fault(&mut self, faults: &[Fault], i: usize, t: f64) {
        (self.fault_gain, self.fault_max) = (1.0, f64::INFINITY);
        for fault in faults.iter().filter(|fault| fault.concerns(i) && fault.active(t)) {
            let Acts::Drive(what) = Acts::of(fault.kind) else { continue };
            match what {
                DriveFault::Gain => self.fault_gain *= fault.size,
                DriveFault::Limit => self.fault_max = self.fault_max.min(fault.size),
            }
        }
    }

    /// Returns true if the torque varies with the rotor's angle.
    pub(super) fn waves(&self) -> bool {
        self.ripple > 0.0 || self.cogging > 0.0
    }

    /// Torque that acts \[N·m\].
    pub(super) fn torque(&self, told: f64, t: f64, q: f64, dq: f64) -> f64 {
        let mut tau = self.gain * (1.0 + self.drift * t) * self.fault_gain * told;
        if self.waves() {
            let wave = libm::sin(self.per_turn * q);
            tau = tau * (1.0 + self.ripple * wave) + self.cogging * wave;
        }
        let mut limit = self.max.min(self.fault_max);
        if tau * dq > 0.0 && self.no_load_speed.is_finite() {
            limit = limit.min(self.max * (1.0 - dq.abs() / self.no_load_speed).max(0.0));
        }
        if tau > limit {
            limit
        } else if tau < -limit {
            -limit
        } else {
            tau
        }
    }
}
