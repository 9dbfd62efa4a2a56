//! Watches one joint for what no guard of a single value can see.

use crate::Real;

// How long these watch is counted in samples, not in seconds, on purpose. An oscillation near the sample rate has its
// period in samples, and so has the delay that makes it; and how sure a verdict is depends on how many samples
// it has seen: 5 ms of a frozen sensor would be one repeated reading at 200 Hz.

/// Readings in a row without a change that make a sensor frozen, once the joint should have moved: a drive's bus
/// repeats one or two.
const FROZEN_SAMPLES: u32 = 5;

/// Samples that the mean square of the second difference, and the covariance of torque and step, are taken over: long
/// against the two samples of the fastest oscillation, short against the 50 ms in which an arm has to stop.
const MEAN_SAMPLES: u32 = 16;

/// Sign changes of the last 32 second differences that make an oscillation: a blow has two or three.
const SIGN_CHANGES: u32 = 5;

/// Of the last 32 samples: two neighbours differ in at most 31 places.
const NEIGHBOURS: u32 = 0x7fff_ffff;

/// Samples in a row above the threshold that make an oscillation: what is left of one blow in the mean has halved by
/// then.
const HOT_SAMPLES: u32 = 8;

/// Samples in a row in which the joint does not follow its torque that make a fault at first motion: while a load
/// sets in it looks so for less.
pub(crate) const SUSPICIOUS_SAMPLES: u32 = 15;

/// A position that does not change while the joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Frozen<R> {
    same: u32,
    travel: R,
}

impl<R: Real> Frozen<R> {
    /// The position stayed where it was over a sample in which it should have moved so far; `true` when the
    /// sensor is frozen.
    pub(crate) fn stay(&mut self, expected: R, travel_max: R) -> bool {
        self.same = self.same.saturating_add(1);
        self.travel += expected;
        self.same >= FROZEN_SAMPLES && self.travel > travel_max
    }
}

/// Oscillation of the torque demand near the sample rate: what a joint does that is lighter than its window.
///
/// # Method
///
/// The second difference of the demand damps what moves slowly by `(2π f T)²` and keeps what alternates. Its
/// mean square over some 16 samples must exceed the threshold, for 8 samples, while it changes sign at
/// least five times in 32: one blow does not.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Oscillation<R> {
    last: [R; 2],
    mean_square: R,
    signs: u32,
    hot: u32,
}

impl<R: Real> Oscillation<R> {
    /// Takes a torque demand; `true` when it oscillates beyond the threshold, squared.
    pub(crate) fn take(&mut self, demand: R, threshold_squared: R) -> bool {
        let [one, two] = self.last;
        let second = demand - R::from_f64(2.0) * one + two;
        self.last = [demand, one];
        self.mean_square = (self.mean_square
            + R::from_f64(1.0 / f64::from(MEAN_SAMPLES)) * (second * second - self.mean_square))
            .snap();
        self.signs = (self.signs << 1) | u32::from(second > R::ZERO);
        let hot = self.mean_square > threshold_squared && self.sign_changes() >= SIGN_CHANGES;
        self.hot = if hot { self.hot.saturating_add(1) } else { 0 };
        self.hot >= HOT_SAMPLES
    }

    /// In the last 32 samples.
    fn sign_changes(&self) -> u32 {
        ((self.signs ^ (self.signs >> 1)) & NEIGHBOURS).count_ones()
    }

    /// Starts anew from a demand that stands still.
    pub(crate) fn restart(demand: R) -> Self {
        Self { last: [demand, demand], ..Self::default() }
    }
}

/// Does the joint accelerate the way the torque pushes?
///
/// # Method
///
/// Covariance of torque and velocity step and variance of torque, since the start (over some 16 samples):
/// under a constant load and an inertia `M` their ratio is `T/M`. A negative one is a wrong sign, one near
/// zero a dead drive or a closed brake. Fifteen such samples in a row count: a load that sets in is seen as
/// one for less.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Actuation<R> {
    torque: R,
    step: R,
    both: R,
    square: R,
    count: u32,
    suspicion: u32,
}

impl<R: Real> Actuation<R> {
    /// Takes a torque and the velocity step it made; `gain` is `T/M` of the heaviest plausible joint,
    /// `excitation` the mean square of torque that is needed for a judgement. `true`: it does not.
    pub(crate) fn take(
        &mut self,
        (torque, step): (R, R),
        gain: R,
        (excitation, samples): (R, u32),
    ) -> bool {
        self.count = if self.count < MEAN_SAMPLES { self.count + 1 } else { MEAN_SAMPLES };
        let rate = R::from_f64(1.0 / f64::from(self.count));
        let (x, y) = (torque - self.torque, step - self.step);
        self.torque += rate * x;
        self.step += rate * y;
        let keep = R::from_f64(1.0) - rate;
        self.both = (keep * (self.both + rate * x * y)).snap();
        self.square = (keep * (self.square + rate * x * x)).snap();
        let wrong = self.square > excitation && self.both < gain * self.square;
        self.suspicion = if wrong { self.suspicion.saturating_add(1) } else { 0 };
        self.suspicion >= samples
    }

    /// Returns true if the joint accelerated the way the torque pushed.
    pub(crate) fn follows(&self, gain: R) -> bool {
        self.both > gain * self.square
    }
}
