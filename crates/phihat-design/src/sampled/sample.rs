//! One sample of the closed loop, as core, sensor, delay, drive and inertia compute it. Both delays stand in one line:
//! see [`LoopModel`].

use nalgebra::DVector;
use phihat::{Form, TorqueSource, VelocitySource};

use super::estimator::estimator_coefficients;
use super::model::LoopParts;
use super::model::{Drive, LoopModel};
use super::open_loop::literal_factors;
use super::positions::Positions;
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
    pub(crate) reference: [f64; 3],
}

/// Places of the entries of the state.
#[derive(Debug, Clone, Copy)]
struct Layout {
    memory: usize,
    /// From positions: where what is filtered of the innovation begins.
    filtered: usize,
    last_position: Option<usize>,
    last_velocity: Option<usize>,
    mean_torque: Option<usize>,
    end_torque: Option<usize>,
    line: usize,
    /// From positions: the last commands, the newest first.
    sent: usize,
    length: usize,
}

impl Layout {
    fn new(order: usize, model: &LoopModel, positions: Option<&Positions>) -> Self {
        let filtered = 4 + order;
        let mut length = 2 + positions.map_or(order, Positions::length);
        let mut entry = |wanted: bool| {
            wanted.then(|| {
                length += 1;
                length - 1
            })
        };
        let fed = positions.is_none();
        let observer = model.form == Form::Observer;
        let last_position = entry(fed && model.velocity == VelocitySource::Differenced);
        let last_velocity = entry(fed && (observer || model.filters()));
        let mean_torque = entry(model.form != Form::Literal);
        let end_torque = entry(model.drive_bandwidth_hz.is_some());
        let line = length;
        length += model.late() as usize;
        let sent = length;
        length += positions.map_or(0, Positions::sent);
        Self {
            memory: 2,
            filtered,
            last_position,
            last_velocity,
            mean_torque,
            end_torque,
            line,
            sent,
            length,
        }
    }
}

impl Layout {
    /// Size of one unit of each entry, in SI.
    fn scale(&self, w: f64, form: Form) -> DVector<f64> {
        let mut scale = DVector::from_element(self.length, w * w);
        scale[0] = 1.0;
        scale[1] = w;
        let first = match form {
            Form::Observer => (w * w, w),
            Form::Literal => (1.0 / w, 1.0 / w),
            Form::Positions => (1.0, w),
        };
        let ends = [self.last_position, self.last_velocity, self.mean_torque, self.end_torque];
        let end = ends.into_iter().flatten().min().unwrap_or(self.line);
        let mut unit = first.0;
        for j in self.memory..end {
            let filtered = form == Form::Positions && j >= self.filtered;
            scale[j] = if filtered { 1.0 } else { unit };
            unit *= first.1;
        }
        if let Some(i) = self.last_position {
            scale[i] = 1.0;
        }
        if let Some(i) = self.last_velocity {
            scale[i] = w;
        }
        scale
    }
}

/// One sample of the loop.
pub(crate) struct Sample<'a> {
    gains: &'a JointRecord,
    model: &'a LoopModel,
    mu: f64,
    layout: Layout,
    /// Observer: `α_{m−1}, …, α_0`, entry `j` feeds memory `j`.
    alpha: Vec<f64>,
    /// Literal: (16).
    factors: Vec<f64>,
    drive: Option<Drive>,
    positions: Option<Positions>,
}

impl<'a> Sample<'a> {
    pub(crate) fn new(gains: &'a JointRecord, model: &'a LoopModel, mu: f64) -> Self {
        let mut alpha = estimator_coefficients(&gains.a, model.period_s);
        alpha.reverse();
        let positions = Positions::of(gains, model.period_s);
        let layout = Layout::new(gains.order(), model, positions.as_ref());
        let factors = literal_factors(gains);
        Self { gains, model, mu, layout, alpha, factors, drive: model.drive(), positions }
    }

    /// Length of the state.
    pub(crate) fn length(&self) -> usize {
        self.layout.length
    }

    /// Size of one unit of each entry of the state, in SI.
    pub(crate) fn scale(&self) -> DVector<f64> {
        self.layout.scale(self.gains.kp_per_s2.sqrt(), self.model.form)
    }

    /// The state at the next sample, and the torque commanded at this one.
    pub(crate) fn step(&self, x: &[f64], input: &Input) -> (Vec<f64>, f64) {
        let position = x[0] + input.encoder;
        let mut next = vec![0.0; self.layout.length];
        let u = match &self.positions {
            Some(law) => self.seen(law, x, (position, input.reference), &mut next),
            None => self.fed(x, (position, input.reference), &mut next),
        };
        let demand = self.delay(x, u, &mut next);
        self.act(x, demand, input.phi, &mut next);
        (next, u)
    }

    /// The law that is fed with velocity.
    fn fed(&self, x: &[f64], (position, reference): (f64, [f64; 3]), next: &mut [f64]) -> f64 {
        let layout = &self.layout;
        let at = |index: Option<usize>| index.map_or(0.0, |i| x[i]);
        let raw = match self.model.velocity {
            VelocitySource::Measured => x[1],
            VelocitySource::Differenced => {
                (position - at(layout.last_position)) / self.model.period_s
            }
        };
        let before = at(layout.last_velocity);
        let velocity = if self.model.filters() {
            before + self.model.filter_gain() * (raw - before)
        } else {
            raw
        };
        let [qd, dqd, ddqd] = reference;
        let (e, de) = (position - qd, velocity - dqd);
        let phi_hat = if self.model.form == Form::Literal {
            self.integrate(x, e, de, next)
        } else {
            self.observe(x, velocity, next)
        };
        if let Some(i) = layout.last_position {
            next[i] = position;
        }
        if let Some(i) = layout.last_velocity {
            next[i] = velocity;
        }
        ddqd - self.gains.kd_per_s * de - self.gains.kp_per_s2 * e + phi_hat
    }

    /// The law from positions. Where its feed-forward acts, the reference does the same: neither is seen.
    fn seen(
        &self,
        law: &Positions,
        x: &[f64],
        (position, [qd, ..]): (f64, [f64; 3]),
        next: &mut [f64],
    ) -> f64 {
        let (first, sent) = (self.layout.memory, self.layout.sent);
        let of = |from: usize, length: usize| -> Vec<Lane<1>> {
            x[from..from + length].iter().map(|value| Lane([*value])).collect()
        };
        let mut held = of(first, law.length());
        let acted = self.layout.mean_torque.map_or(0.0, |i| x[i]);
        law.see(&mut held, &Lane([acted]), &Lane([position - qd]));
        let Lane([u]) = law.answer(&held, &of(sent, law.sent()));
        for (into, Lane([value])) in next[first..].iter_mut().zip(held) {
            *into = value;
        }
        next[sent] = u;
        next[sent + 1..].copy_from_slice(&x[sent..sent + law.sent() - 1]);
        u
    }

    /// The torque that acts at the start of the interval that begins at this sample, for the torque `u` commanded now.
    pub(crate) fn acting(&self, x: &[f64], u: f64) -> f64 {
        match (self.layout.end_torque, self.model.late()) {
            (Some(i), _) => x[i],
            (None, 0) => u,
            (None, _) => x[self.layout.line],
        }
    }

    /// (T4).
    fn observe(&self, x: &[f64], velocity: f64, next: &mut [f64]) -> f64 {
        let (t, first) = (self.model.period_s, self.layout.memory);
        let at = |index: Option<usize>| index.map_or(0.0, |i| x[i]);
        let innovation = t * (at(self.layout.mean_torque) - x[first])
            - (velocity - at(self.layout.last_velocity));
        let m = self.alpha.len();
        for (j, alpha) in self.alpha.iter().enumerate() {
            let derivative = if j + 1 < m { x[first + j + 1] } else { 0.0 };
            next[first + j] = x[first + j] + t * derivative + alpha * innovation;
        }
        next[first]
    }

    /// (9), (10), (16).
    fn integrate(&self, x: &[f64], e: f64, de: f64, next: &mut [f64]) -> f64 {
        let (first, m) = (self.layout.memory, self.alpha.len());
        let mut total = self.factors[m] * e + self.factors[m + 1] * de;
        let mut below = e;
        for j in 0..m {
            below = x[first + j] + self.model.period_s * below;
            next[first + j] = below;
            total += self.factors[m - 1 - j] * below;
        }
        -total
    }

    /// The delay line, oldest entry first.
    fn delay(&self, x: &[f64], u: f64, next: &mut [f64]) -> f64 {
        let (line, d) = (self.layout.line, self.model.late() as usize);
        if d == 0 {
            return u;
        }
        next[line..line + d - 1].copy_from_slice(&x[line + 1..line + d]);
        next[line + d - 1] = u;
        x[line]
    }

    /// Drive and inertia over the interval.
    fn act(&self, x: &[f64], demand: f64, phi: f64, next: &mut [f64]) {
        let t = self.model.period_s;
        let (mut mean, mut double) = (demand, 0.5 * t * t * demand);
        if let (Some(drive), Some(i)) = (&self.drive, self.layout.end_torque) {
            let gap = x[i] - demand;
            mean += drive.mean * gap;
            double += drive.double * gap;
            next[i] = demand + gap * (1.0 - drive.lost);
        }
        if let Some(i) = self.layout.mean_torque {
            next[i] = match self.model.torque {
                TorqueSource::Applied => mean,
                TorqueSource::Demanded => demand,
            };
        }
        next[0] = x[0] + t * x[1] + (double - 0.5 * t * t * phi) / self.mu;
        next[1] = x[1] + t * (mean - phi) / self.mu;
    }
}
