//! Rank of gains by their tube, and the shares of the torque noise for the next ones.

use phihat_certificate::extremes::Extremes as _;
use phihat_design::Tube;
use phihat_study::Study;

use crate::judged::{Judged, SETTLED_S, late_error};

/// Limits of the encoder's share of the torque step that a study allows.
pub(crate) const SHARES: (f64, f64) = (0.01, 1.0);

/// The error of a law falls by about this power of its noise.
const POWER: f64 = 0.4;

/// The change of torque of a tube falls by about this power of the encoder's share: its other causes fall
/// less.
const STEP_POWER: f64 = 0.95;

/// Share of the allowed torque step that a search aims at.
pub(crate) const ROOM: f64 = 0.97;

/// A tube that uses less of the specification than this leaves room for less noise.
const ENOUGH: f64 = 0.85;

/// Figures of each joint by a tube: its error and its change of torque, over their allowed values.
#[derive(Debug, Clone)]
pub(crate) struct TubeFigures {
    errors: Vec<f64>,
    steps: Vec<f64>,
}

impl TubeFigures {
    /// `None` where there is no tube.
    pub(crate) fn of(study: &Study, tube: Option<&Tube>, judged: &Judged) -> Option<Self> {
        let (Judged::Kept(errors) | Judged::Beyond(errors)) = judged else { return None };
        let period = study.control.period_ns as f64 * 1e-9;
        let step = |i: usize| -> f64 {
            let Some(joint) = tube.map(|tube| &tube.joints[i]) else { return 0.0 };
            let allowed = study.design.torque_step_max.as_ref().map(|most| most[i]);
            let steady = allowed.map_or(0.0, |allowed| joint.torque_step_steady_max_nm / allowed);
            // A limit must not act from the start on.
            let limit = study.limits(i).1.map(|rate| rate * period);
            limit.map_or(steady, |limit| steady.max(joint.torque_step_max_nm / limit))
        };
        let steps = (0..errors.len()).map(step).collect();
        let mut errors = errors.clone();
        // Where the time to settle is what the tube says, an error that is kept at the very end is none that is kept.
        let asked = tube.filter(|_| !study.spec.settle_stated).zip(study.spec.error_bound.as_ref());
        if let Some((tube, allowed)) = asked {
            let from = SETTLED_S.min(0.5 * study.duration);
            for ((error, joint), allowed) in errors.iter_mut().zip(&tube.joints).zip(allowed) {
                *error = error.max(late_error(tube.bin_s, joint, from) / allowed);
            }
        }
        Some(Self { errors, steps })
    }

    /// Figure by figure; 1 where one is of nothing.
    pub(crate) fn over(&self, other: &Self) -> Self {
        let ratio = |(a, b): (&f64, &f64)| if *b > 0.0 { a / b } else { 1.0 };
        Self {
            errors: self.errors.iter().zip(&other.errors).map(ratio).collect(),
            steps: self.steps.iter().zip(&other.steps).map(ratio).collect(),
        }
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let product = |(a, b): (&f64, &f64)| a * b;
        Self {
            errors: self.errors.iter().zip(&other.errors).map(product).collect(),
            steps: self.steps.iter().zip(&other.steps).map(product).collect(),
        }
    }
}

/// Rank of gains.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rank {
    /// True if no claim is refused.
    pub(crate) armed: bool,
    /// The largest share of an error that is allowed; infinite without a tube.
    pub(crate) error: f64,
    /// The largest share of a change of torque that is allowed.
    pub(crate) loudest: f64,
    /// The largest share of the noise.
    pub(crate) noise: f64,
}

impl Rank {
    const UNKNOWN: Self =
        Self { armed: true, error: f64::INFINITY, loudest: f64::INFINITY, noise: f64::INFINITY };

    /// Returns true if the tube satisfies every clause.
    pub(crate) fn kept(&self) -> bool {
        self.error <= 1.0 && self.loudest <= 1.0
    }

    /// Stage of a search, and its figure, the smaller the better: torque within its limits, then the error,
    /// then the noise.
    fn stage(&self) -> (u8, f64) {
        if !self.armed {
            (0, self.loudest)
        } else if self.kept() {
            (3, self.noise)
        } else if self.loudest <= 1.0 {
            (2, self.error)
        } else {
            (1, self.loudest)
        }
    }

    /// Returns true if laws of one kind are better than those of another, whose shares of the noise have
    /// another reference.
    pub(crate) fn pays(&self, other: &Self) -> bool {
        if self.armed && self.kept() && other.kept() {
            self.loudest < other.loudest
        } else {
            self.beats(other, 0.0)
        }
    }

    /// Returns true if it is better, by more than a share.
    pub(crate) fn beats(&self, other: &Self, share: f64) -> bool {
        let ((own, value), (theirs, others)) = (self.stage(), other.stage());
        own > theirs || (own == theirs && value < (1.0 - share) * others)
    }
}

/// Rank of gains, and the shares to try next; `None`: these are the last.
pub(crate) fn next(
    judged: &Judged,
    found: Option<&TubeFigures>,
    shares: &[f64],
) -> (Rank, Option<Vec<f64>>) {
    let to = |factor: &dyn Fn(usize) -> f64| -> Option<Vec<f64>> {
        let moved = shares.iter().enumerate();
        Some(moved.map(|(i, s)| (s * factor(i)).clamp(SHARES.0, SHARES.1)).collect())
    };
    let Some(TubeFigures { errors, steps }) = found else {
        // Stiffer laws close a tube sooner.
        let open = matches!(judged, Judged::Open);
        return (Rank::UNKNOWN, if open { to(&|_| 1.5) } else { None });
    };
    let most = |list: &[f64]| list.iter().copied().largest();
    let (error, loudest) = (most(errors), most(steps));
    let rank = Rank { armed: true, error, loudest, noise: most(shares) };
    // All joints get stiffer where one has too much error, as far as each has room: they push each other.
    let needed = libm::pow(1.03 * error, 1.0 / POWER);
    let factor = |i: usize| {
        let room = if steps[i] > 0.0 { ROOM / steps[i] } else { f64::INFINITY };
        let softer = libm::pow(room, 1.0 / STEP_POWER);
        if error > 1.0 {
            if room < 1.0 { softer } else { needed.min(room) }
        } else if steps[i] > 1.0 {
            softer
        } else if loudest <= 1.0 && error < ENOUGH {
            libm::pow(error / ENOUGH.sqrt(), 1.0 / POWER).max(0.2)
        } else {
            1.0
        }
    };
    (rank, to(&factor))
}
