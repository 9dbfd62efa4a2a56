//! One sample of the closed loop: the control side of one joint against an inertia, in units of `M̄`. Both delays stand
//! in one line: see [`LoopModel`].

use nalgebra::DVector;

use super::control_side::{ControlSide, ControlState, Jet};
use super::model::LoopModel;
use crate::JointRecord;
use crate::lanes::Lane;

/// The inputs of one sample.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Input {
    /// `φ/M̄`, held over the interval \[rad/s²\].
    pub(crate) phi: f64,
    /// Error that the encoder adds to the position \[rad\].
    pub(crate) encoder: f64,
    /// `q_d, q̇_d, q̈_d`.
    pub(crate) reference: Jet,
}

/// One sample of the loop.
pub(crate) struct SampledLoop {
    side: ControlSide,
    period: f64,
    mu: f64,
    /// `ω = √K_p` \[1/s\].
    bandwidth: f64,
    /// Units of the states of the control side, as rad/s^k.
    powers: Vec<i8>,
}

impl SampledLoop {
    pub(crate) fn new(gains: &JointRecord, model: &LoopModel, mu: f64) -> Self {
        let side = ControlSide::unit(gains, model);
        let powers = side.powers();
        Self { side, period: model.period_s, mu, bandwidth: gains.kp_per_s2.sqrt(), powers }
    }

    /// Length of the state: position, velocity, the control side's.
    pub(crate) fn length(&self) -> usize {
        2 + self.powers.len()
    }

    /// Size of one unit of each entry of the state, in SI: 1 rad in time units of `1/ω`.
    pub(crate) fn scale(&self) -> DVector<f64> {
        let unit = |power: i8| {
            let of = if power < 0 { self.bandwidth.recip() } else { self.bandwidth };
            (0..power.unsigned_abs()).fold(1.0, |unit, _| unit * of)
        };
        let powers = [0, 1].iter().chain(&self.powers);
        DVector::from_iterator(self.length(), powers.map(|power| unit(*power)))
    }

    /// The state at the next sample, and the torque commanded at this one.
    pub(crate) fn step(&self, x: &[f64], input: &Input) -> (Vec<f64>, f64) {
        let mut control = self.control(x);
        let t = self.period;
        let measured = (&Lane([x[0] + input.encoder]), &Lane([x[1]]));
        let message = control.sense(&self.side, (false, false), measured);
        // Where a law subtracts its feed-forward, the reference does the same.
        let [q, dq, ddq] = input.reference;
        let forward = if self.side.subtracts_feed_forward() { 0.0 } else { ddq };
        let command = control.command(&self.side, false, [q, dq, forward], &message);
        let (Lane([mean]), Lane([bulge])) = control.act(&self.side, &command);
        let double = 0.5 * t * t * (mean - input.phi) + bulge;
        let mut next = vec![x[0] + t * x[1] + double / self.mu];
        next.push(x[1] + t * (mean - input.phi) / self.mu);
        next.extend(control.states(&self.side).map(|state| state[0]));
        (next, command[0])
    }

    /// The torque that acts at the start of the interval that begins at this sample, for the torque `u` commanded now.
    pub(crate) fn acting(&self, x: &[f64], u: f64) -> f64 {
        self.control(x).acting(&self.side, &Lane([u]))[0]
    }

    /// Place in the state of the torque that the law is fed as that of the interval before; `None`: it is fed none.
    pub(crate) fn acted(&self) -> Option<usize> {
        self.side.acted().map(|place| 2 + place)
    }

    /// The control side at a state.
    fn control(&self, x: &[f64]) -> ControlState<1> {
        let mut control = ControlState::new(&self.side);
        for (state, value) in control.states(&self.side).zip(&x[2..]) {
            *state = Lane([*value]);
        }
        control
    }
}
