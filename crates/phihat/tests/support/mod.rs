//! One joint, integrated exactly: `J q̈ = τ − d` under zero-order hold. Independent of the core.
#![allow(
    dead_code,
    clippy::large_types_passed_by_value,
    reason = "each test file uses its part, and a test reads better with values"
)]

use phihat::{Command, Delay, Form, JointDesign, JointGains, JointState, Measurement, Reference};

/// Paper-like outer loop.
pub(crate) const KP: f64 = 400.0;
/// Paper-like outer loop.
pub(crate) const KD: f64 = 40.0;

/// Gains of inertia 1 at a period.
pub(crate) fn gains(a: &[f64], period: f64, form: Form) -> JointGains<f64> {
    JointGains::new(&JointDesign { inertia: 1.0, kp: KP, kd: KD, a, period, form }).unwrap()
}

/// One joint under control.
pub(crate) struct Loop {
    pub(crate) gains: JointGains<f64>,
    pub(crate) state: JointState<f64>,
    pub(crate) inertia: f64,
    pub(crate) period: f64,
    pub(crate) q: f64,
    pub(crate) dq: f64,
    pub(crate) tau_applied: f64,
    pub(crate) delay: Delay<f64>,
    pub(crate) k: u32,
}

impl Loop {
    pub(crate) fn new(gains: JointGains<f64>, inertia: f64, period: f64) -> Self {
        Self {
            gains,
            state: JointState::new(),
            inertia,
            period,
            q: 0.0,
            dq: 0.0,
            tau_applied: 0.0,
            delay: Delay::new(0).unwrap(),
            k: 0,
        }
    }

    pub(crate) fn time(&self) -> f64 {
        f64::from(self.k) * self.period
    }

    pub(crate) fn measurement(&self) -> Measurement<f64> {
        Measurement { q: self.q, dq: self.dq, tau_applied: self.tau_applied }
    }

    /// One sample under a disturbance that is constant over the interval.
    pub(crate) fn step(&mut self, reference: &Reference<f64>, disturbance: f64) -> Command<f64> {
        let measurement = self.measurement();
        let command = self.gains.update(&mut self.state, &measurement, reference);
        self.apply(command.tau, disturbance);
        command
    }

    /// One period under a commanded torque.
    pub(crate) fn apply(&mut self, tau: f64, disturbance: f64) {
        self.tau_applied = self.delay.pass(tau);
        let ddq = (self.tau_applied - disturbance) / self.inertia;
        self.q += self.period * self.dq + 0.5 * self.period * self.period * ddq;
        self.dq += self.period * ddq;
        self.k += 1;
    }
}
