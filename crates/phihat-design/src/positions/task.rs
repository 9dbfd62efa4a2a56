//! Requests of one joint to its law, and the cost of a law.

use core::f64::consts::PI;
use phihat_certificate::extremes::Extremes as _;

use super::family::Family;
use super::response::{LawResponse, PlayedLoop};
use crate::sampled::{Law, LoopModel, OpenLoop, from_segment};
use crate::{JointRecord, Phi};

/// Frequencies at which the distance from −1 is looked at.
const ANGLES: u32 = 80;

/// Lowest of them \[rad/sample\].
const LOWEST: f64 = 2e-3;

/// Inertia ratios at which gains are looked at.
const RATIOS: u32 = 4;

/// Least cost of a law that does not hold; the more it misses by, the more.
const NONE: f64 = 1e3;

/// Weight of a jump of φ: it does not act where the rest of a tube is at its worst, and a tube includes the
/// time.
const JUMP: f64 = 0.5;

/// Cost of noise beyond the allowed, by its logarithm.
const STEEP: f64 = 30.0;

/// Requests of one joint.
pub(super) struct Task<'a> {
    pub(super) family: Family,
    pub(super) model: LoopModel,
    pub(super) inertia: f64,
    pub(super) phi: &'a Phi,
    pub(super) quantum: f64,
    /// The arm's range of inertia, without margin, and the margin.
    pub(super) range: (f64, f64),
    /// The range of inertia over which errors and noise are looked at.
    pub(super) shown: (f64, f64),
    pub(super) margin: f64,
    pub(super) modulus: f64,
    /// Allowed change of torque per sample, per radian that a reading is off \[N·m/rad\].
    pub(super) change: f64,
    /// Allowed `|ė|` over allowed `|e|` \[1/s\], where both are asked for.
    pub(super) velocity: Option<f64>,
    /// Weights of its estimates; `None`: not weighted.
    pub(super) weights: Option<TaskWeights>,
}

/// Weights of the parts of an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TaskWeights {
    /// Of the error: what moves smoothly, what jumps, what the encoder does.
    pub(super) error: [f64; 3],
    /// Of the change of torque: what the encoder does \[1\], and what `φ` does by its jumps \[1/rad\].
    pub(super) change: [f64; 2],
}

/// The parts of what a law does for its joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TaskParts {
    /// Of `|e|` \[rad\], and of `|ė|` \[rad/s\]: what moves smoothly, what jumps, what the encoder does.
    pub(super) errors: [[f64; 3]; 2],
    /// Bounds of `|e|` and `|ė|` as a whole.
    whole: [f64; 2],
    /// Of the change of torque per sample: by the encoder \[N·m\] per radian of reading error, and by jumps
    /// of `φ` \[N·m\].
    pub(super) change: [f64; 2],
}

/// Estimates for a law of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Worth {
    /// Estimate of `|e|` \[rad\] and `|ė|` \[rad/s\].
    pub(super) error: f64,
    pub(super) velocity: f64,
    /// Change of torque per sample \[N·m\] per radian that a reading is off.
    pub(super) change: f64,
}

impl Task<'_> {
    /// The same for laws that filter their innovation, where these numbers are of one.
    pub(super) fn with_filter(mut self, x: &[f64]) -> Self {
        self.family.filtered = !self.family.has(x);
        self
    }

    /// The cost of a law of the family: the logarithm of its error, and more where it is too loud.
    pub(super) fn cost(&self, x: &[f64]) -> f64 {
        let Some(record) = self.family.record(x, "", self.inertia) else { return 2.0 * NONE };
        let Ok(law) = Law::of(&record, &self.model) else { return 1.5 * NONE };
        if !self.holds(&law) {
            return 1.5 * NONE;
        }
        let short = self.modulus - self.modulus(&law, record.order());
        if short > 0.0 {
            return NONE * (1.0 + 0.1 * short);
        }
        let Some(worth) = self.worth_of(&law) else { return 1.5 * NONE };
        let velocity = self.velocity.map_or(0.0, |rate| worth.velocity / rate);
        let loud = libm::log(worth.change / self.change).max(0.0);
        libm::log(worth.error.max(velocity)) + STEEP * loud
    }

    /// Returns true if the response dies out at both ends of the range and its margin.
    fn holds(&self, law: &Law) -> bool {
        let (low, high) = self.range;
        let ends = [low / self.margin, high * self.margin];
        PlayedLoop::new(law, &self.model, ends).forget()
    }

    /// Estimate of the smallest distance from −1 over the range.
    fn modulus(&self, law: &Law, order: usize) -> f64 {
        let open = OpenLoop::of_law(law, order, &self.model);
        let (low, high) = self.range;
        let step = libm::log(PI / LOWEST) / f64::from(ANGLES - 1);
        (0..ANGLES)
            .map(|k| {
                let value = open.at_angle(LOWEST * libm::exp(step * f64::from(k)));
                from_segment(value / low + 1.0, value / high + 1.0)
            })
            .least()
    }

    /// The parts of what a law does, over the range; `None` where it does not hold.
    pub(super) fn parts(&self, record: &JointRecord) -> Option<TaskParts> {
        self.parts_of(&Law::of(record, &self.model).ok()?)
    }

    fn parts_of(&self, law: &Law) -> Option<TaskParts> {
        let (low, high) = self.shown;
        let share = |k: u32| f64::from(k) / f64::from(RATIOS - 1);
        let mu: Vec<f64> = (0..RATIOS).map(|k| low * libm::pow(high / low, share(k))).collect();
        let gains = LawResponse::of(law, &self.model, &mu)?;
        let t = self.model.period_s;
        let part = |i: usize| {
            let jump = JUMP * gains.jump[i];
            let own = self.phi.bound(jump, Some(gains.ramp[i])) / self.inertia;
            let kick = gains.kick[i] * t * t;
            let moved = self
                .phi
                .motion
                .map_or(0.0, |motion| motion.costs(0.25 * kick, Some(t * kick / 12.0)));
            let reading = 0.5 * self.quantum * gains.reading[i];
            let jumps = jump * self.phi.jump_nm / self.inertia;
            ([(own - jumps).max(0.0) + moved, jumps.min(own), reading], own + moved + reading)
        };
        let ((error, whole), (rate, whole_rate)) = (part(0), part(1));
        let jolt = JUMP * gains.jolt * self.phi.jump_nm;
        Some(TaskParts {
            errors: [error, rate],
            whole: [whole, whole_rate],
            change: [self.inertia * gains.change, jolt],
        })
    }

    /// Estimates for a law, with its parts weighted; `None` where it does not hold.
    pub(super) fn worth(&self, record: &JointRecord) -> Option<Worth> {
        self.worth_of(&Law::of(record, &self.model).ok()?)
    }

    fn worth_of(&self, law: &Law) -> Option<Worth> {
        let TaskParts { errors, whole: [error, velocity], change } = self.parts_of(law)?;
        let Some(weights) = &self.weights else {
            return Some(Worth { error, velocity, change: change[0] });
        };
        let sum = |parts: &[f64], weights: &[f64]| -> f64 {
            parts.iter().zip(weights).map(|(part, weight)| part * weight).sum()
        };
        Some(Worth {
            error: sum(&errors[0], &weights.error),
            velocity: sum(&errors[1], &weights.error),
            // A jolt counts as the reading that does as much.
            change: sum(&change, &weights.change),
        })
    }
}
