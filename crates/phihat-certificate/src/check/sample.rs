//! One sample of the closed loop, signal by signal, in the frame of a reference that moves with a constant
//! acceleration.

use super::drive::{drive, filter, literal};
use super::estimator;
use super::sight::Sight;
use crate::{JointRecord, LoopModel};
use phihat::{Form, TorqueSource, VelocitySource};
use phihat_kernel::Drive;

/// Longest line of delayed commands: both delays.
pub(crate) const LINE: usize = 2 * phihat::DELAY_MAX;

/// Most that an estimator remembers: what it expects, and two numbers of each section of a filter.
pub(crate) const MEMORY: usize = 5 + 2 * phihat::SECTIONS_MAX;

/// Most torques that a law from positions remembers.
pub(crate) const SENT: usize = 4;

/// All that the loop remembers from one sample to the next, against the reference, per unit of `M̄`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Signals {
    /// `e` \[rad\].
    pub(crate) q: f64,
    /// `ė` \[rad/s\].
    pub(crate) v: f64,
    /// Observer: `φ̂_j/M̄`. Literal: the integrals of e. From positions: `ê`, `ė̂`, `φ̂_j/M̄`, and `x`, `δ`
    /// of each section of the filter.
    pub(crate) memory: [f64; MEMORY],
    /// From positions: the last commands, the newest first.
    pub(crate) sent: [f64; SENT],
    /// Position sensed at the last sample.
    pub(crate) position: f64,
    /// Velocity given to the law at the last sample.
    pub(crate) velocity: f64,
    /// Mean torque of the interval just ended, as the observer is told.
    pub(crate) mean: f64,
    /// Torque at its end.
    pub(crate) end: f64,
    /// Commands on their way, the next to act first.
    pub(crate) line: [f64; LINE],
}

impl Signals {
    pub(crate) const REST: Self = Self {
        q: 0.0,
        v: 0.0,
        memory: [0.0; MEMORY],
        sent: [0.0; SENT],
        position: 0.0,
        velocity: 0.0,
        mean: 0.0,
        end: 0.0,
        line: [0.0; LINE],
    };

    /// `self − other`.
    pub(crate) fn minus(&self, other: &Self) -> Self {
        let mut out = *self;
        out.q -= other.q;
        out.v -= other.v;
        out.position -= other.position;
        out.velocity -= other.velocity;
        out.mean -= other.mean;
        out.end -= other.end;
        for (a, b) in out.memory.iter_mut().zip(&other.memory) {
            *a -= b;
        }
        for (a, b) in out.sent.iter_mut().zip(&other.sent) {
            *a -= b;
        }
        for (a, b) in out.line.iter_mut().zip(&other.line) {
            *a -= b;
        }
        out
    }
}

/// Inputs of the loop in one sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Outside {
    /// `φ/M̄` held over the coming interval \[rad/s²\].
    pub(crate) phi: f64,
    /// Encoder error added to the position \[rad\].
    pub(crate) reading: f64,
    /// `q̈_d` of the interval just ended, and of the coming one \[rad/s²\].
    pub(crate) acceleration: (f64, f64),
    /// True if the coming acceleration is fed forward.
    pub(crate) fed: bool,
}

/// One joint's loop at one inertia ratio.
#[derive(Debug, Clone)]
pub(crate) struct Loop {
    pub(crate) model: LoopModel,
    pub(crate) order: usize,
    pub(crate) mu: f64,
    pub(crate) period: f64,
    pub(crate) kp: f64,
    kd: f64,
    /// `α_{m−1} … α_0` of (T4).
    alpha: Vec<f64>,
    /// (16).
    k: Vec<f64>,
    filter: Option<f64>,
    drive: Option<Drive>,
    pub(crate) late: usize,
    pub(crate) sight: Option<Sight>,
}

impl Loop {
    pub(crate) fn new(record: &JointRecord, model: &LoopModel, mu: f64) -> Self {
        let order = record.order();
        let mut alpha = estimator::sampled(&record.a, model.period_s);
        for (i, b) in alpha.iter_mut().enumerate() {
            *b /= (i..order).fold(1.0, |power, _| power * model.period_s);
        }
        alpha.reverse();
        Self {
            model: *model,
            order,
            mu,
            period: model.period_s,
            kp: record.kp_per_s2,
            kd: record.kd_per_s,
            alpha,
            k: literal(record),
            filter: filter(model),
            drive: drive(model),
            sight: Sight::of(record, model.period_s),
            late: (model.delay_samples + model.sample_delay_samples) as usize,
        }
    }

    /// Returns true if the loop has a drive, whose torque is a state.
    pub(crate) fn drives(&self) -> bool {
        self.drive.is_some()
    }

    /// The highest integral that gives a torque of 1 by itself.
    pub(crate) fn integral_of_one(&self) -> f64 {
        -1.0 / self.k[0]
    }

    /// The next sample's signals, and the torque commanded at this one.
    pub(crate) fn step(&self, x: &Signals, outside: &Outside) -> (Signals, f64) {
        let (before, ahead) = outside.acceleration;
        let mut next = *x;
        next.position = x.q + outside.reading;
        let u = match &self.sight {
            // Its feed-forward is the mean acceleration of the interval in which the torque acts: what the reference
            // does leaves nothing to see.
            Some(sight) => seen(sight, x, &mut next),
            None => self.fed(x, &mut next, (before, if outside.fed { ahead } else { 0.0 })),
        };
        next.line.copy_within(1.., 0);
        let told = if self.late == 0 {
            u
        } else {
            next.line[self.late - 1] = u;
            x.line[0]
        };
        let ahead = if self.sight.is_some() && outside.fed { 0.0 } else { ahead };
        self.act(x, &mut next, (told, outside.phi, ahead));
        (next, u)
    }

    /// The law that is fed with velocity: its torque, with what the reference's acceleration was before and adds now.
    fn fed(&self, x: &Signals, next: &mut Signals, (before, fed): (f64, f64)) -> f64 {
        let t = self.period;
        let raw = match self.model.velocity {
            VelocitySource::Measured => x.v,
            VelocitySource::Differenced => (next.position - x.position) / t - 0.5 * t * before,
        };
        // The reference's velocity has grown by `before · T` since the last sample.
        let kept = x.velocity - before * t;
        next.velocity = self.filter.map_or(raw, |share| kept + share * (raw - kept));
        let phi_hat = if self.model.form == Form::Literal {
            let m = self.order;
            let mut sum = next.position;
            let mut held = self.k[m] * next.position + self.k[m + 1] * next.velocity;
            for j in 0..m {
                sum = x.memory[j] + t * sum;
                next.memory[j] = sum;
                held += self.k[m - 1 - j] * sum;
            }
            -held
        } else {
            let innovation = t * (x.mean - x.memory[0]) - (next.velocity - kept);
            for j in 0..self.order {
                let above = if j + 1 < self.order { x.memory[j + 1] } else { 0.0 };
                next.memory[j] = x.memory[j] + t * above + self.alpha[j] * innovation;
            }
            next.memory[0]
        };
        fed - self.kd * next.velocity - self.kp * next.position + phi_hat
    }

    /// Drive and inertia over the coming interval.
    fn act(&self, x: &Signals, next: &mut Signals, (told, phi, ahead): (f64, f64, f64)) {
        let t = self.period;
        let (mut mean, mut double) = (told, 0.5 * t * t * told);
        if let Some(drive) = self.drive {
            let gap = x.end - told;
            mean += drive.mean * gap;
            double += drive.double * gap;
            next.end = told + (1.0 - drive.lost) * gap;
        }
        next.mean = match self.model.torque {
            TorqueSource::Applied => mean,
            TorqueSource::Demanded => told,
        };
        next.q = x.q + t * x.v + (double - 0.5 * t * t * phi) / self.mu - 0.5 * t * t * ahead;
        next.v = x.v + t * (mean - phi) / self.mu - t * ahead;
    }
}

/// The law from positions.
fn seen(sight: &Sight, x: &Signals, next: &mut Signals) -> f64 {
    let length = sight.length();
    sight.see(&mut next.memory[..length], x.mean, next.position);
    let u = sight.answer(&next.memory[..length], &x.sent);
    next.sent.copy_within(..SENT - 1, 1);
    next.sent[0] = u;
    u
}
