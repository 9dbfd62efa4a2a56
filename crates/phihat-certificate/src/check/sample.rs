//! One sample of the closed loop, signal by signal, in the frame of a reference that moves with a constant
//! acceleration.

use super::drive::{drive, filter};
use super::law::LawMatrices;
use crate::{JointRecord, LoopModel};
use phihat::{Form, STATE_ENTRIES, TorqueSource, VelocitySource};
use phihat_kernel::DriveModel;

/// Longest line of delayed commands: both delays.
pub(crate) const LINE: usize = 2 * phihat::DELAY_MAX;

/// All that the loop remembers from one sample to the next, against the reference, per unit of `M̄`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Signals {
    /// `e` \[rad\].
    pub(crate) q: f64,
    /// `ė` \[rad/s\].
    pub(crate) v: f64,
    /// State of the law: [`LawMatrices::entries`].
    pub(crate) law: [f64; STATE_ENTRIES],
    /// Position sensed at the last sample.
    pub(crate) position: f64,
    /// Velocity given to the law at the last sample, where the law does not remember it.
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
        law: [0.0; STATE_ENTRIES],
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
        for (a, b) in out.law.iter_mut().zip(&other.law) {
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
    pub(crate) law: LawMatrices,
    /// True if the feed-forward acts in the interval that it is for.
    pub(crate) in_time: bool,
    filter: Option<f64>,
    drive: Option<DriveModel>,
    pub(crate) late: usize,
}

impl Loop {
    pub(crate) fn new(record: &JointRecord, model: &LoopModel, mu: f64) -> Self {
        Self {
            model: *model,
            order: record.order(),
            mu,
            period: model.period_s,
            kp: record.kp_per_s2,
            law: LawMatrices::unit(record, model),
            in_time: record.fed_in_time(model),
            filter: filter(model),
            drive: drive(model),
            late: (model.delay_samples + model.sample_delay_samples) as usize,
        }
    }

    /// Returns true if the loop has a drive, whose torque is a state.
    pub(crate) fn drives(&self) -> bool {
        self.drive.is_some()
    }

    /// The same signals after a sample at which the law got a velocity.
    pub(crate) fn with_velocity(&self, signals: &Signals, velocity: f64) -> Signals {
        let mut out = *signals;
        match self.law.register() {
            Some(at) => out.law[at] = velocity,
            None => out.velocity = velocity,
        }
        out
    }

    /// The next sample's signals, and the torque commanded at this one.
    pub(crate) fn step(&self, x: &Signals, outside: &Outside) -> (Signals, f64) {
        let (before, ahead) = outside.acceleration;
        let mut next = *x;
        next.position = x.q + outside.reading;
        let velocity =
            if self.law.uses_velocity() { self.sensed(x, &mut next, before) } else { 0.0 };
        // The feed-forward of a law from positions is the mean acceleration of the interval in which the torque acts:
        // what the reference does leaves nothing to see.
        let seen = self.model.form != Form::Positions || !outside.fed;
        let fed = if seen && outside.fed { ahead } else { 0.0 };
        let length = self.law.len();
        let u = self.law.step(&mut next.law[..length], &[next.position, velocity, x.mean, fed]);
        next.line.copy_within(1.., 0);
        let told = if self.late == 0 {
            u
        } else {
            next.line[self.late - 1] = u;
            x.line[0]
        };
        self.act(x, &mut next, (told, outside.phi, if seen { ahead } else { 0.0 }));
        (next, u)
    }

    /// Velocity that the law gets, where the reference's has grown by `before · T` since the last sample.
    fn sensed(&self, x: &Signals, next: &mut Signals, before: f64) -> f64 {
        let t = self.period;
        let raw = match self.model.velocity {
            VelocitySource::Measured => x.v,
            VelocitySource::Differenced => (next.position - x.position) / t - 0.5 * t * before,
        };
        let last = match self.law.register() {
            Some(at) => {
                next.law[at] -= before * t;
                next.law[at]
            }
            None => x.velocity - before * t,
        };
        let velocity = self.filter.map_or(raw, |share| last + share * (raw - last));
        if self.law.register().is_none() {
            next.velocity = velocity;
        }
        velocity
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
