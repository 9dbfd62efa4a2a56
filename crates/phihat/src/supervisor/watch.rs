//! Faults in one joint's sample before the law runs, and the check of its measured torque.

use super::follow::JointNews;
use super::memory::JointMemory;
use super::monitor::Frozen;
use super::rules::JointRules;
use crate::{Events, Fault, JointGains, Measurement, Real};

/// Share of the reference's velocity at which a joint has to move for its sensor to be called frozen: the rest may be
/// error, load and friction.
const FOLLOWED_SHARE: f64 = 0.2;

/// Samples in a row above the velocity limit that make a joint too fast: one may be noise.
const FAST_SAMPLES: u32 = 3;

/// Samples in a row beyond a certified bound that stop the arm: one or two may be readings that no noise explains.
const BEYOND_SAMPLES: u32 = 3;

/// Share per sample by which a torque commanded earlier is forgotten, as one that the drive may still give: a
/// drive of 5 Hz at 1 kHz.
const FORGOTTEN_SHARE: f64 = 1.0 / 32.0;

/// Share of the torque limit by which a measured torque may be off what was commanded: ripple, friction ahead
/// of the sensor, gain.
const TORQUE_SLACK: f64 = 0.5;

impl<R: Real> JointRules<R> {
    /// Fault in this joint's sample, if any.
    pub(crate) fn watch(
        &self,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        period: R,
        law: bool,
    ) -> Option<Fault> {
        if self.range.as_ref().is_some_and(|range| range.left(m.q)) {
            return Some(Fault::JointLimit);
        }
        let fast = m.dq.abs() > self.velocity_max;
        memory.fast = if fast { memory.fast.saturating_add(1) } else { 0 };
        if memory.fast >= FAST_SAMPLES {
            return Some(Fault::Overspeed);
        }
        if !law {
            return None;
        }
        if (m.q - memory.reference.q).abs() > self.error_stop {
            return Some(Fault::TrackingError);
        }
        let travel = self.frozen_travel?;
        if m.q - memory.measured.q != R::ZERO {
            memory.frozen = Frozen::default();
            return None;
        }
        // It moves, or should.
        let asked = R::from_f64(FOLLOWED_SHARE) * memory.reference.dq.abs();
        let speed = if m.dq.abs() > asked { m.dq.abs() } else { asked };
        memory.frozen.stay(speed * period, travel).then_some(Fault::Frozen)
    }

    /// Compares the measured error with its certified bound: beyond it for some samples, something acts that the
    /// certificate does not count.
    #[inline]
    pub(crate) fn compare_with_bound(
        &self,
        memory: &mut JointMemory<R>,
        error: R,
        news: &mut JointNews,
    ) {
        let share = error.abs() * self.bound_inverse;
        let beyond = share > R::from_f64(1.0);
        memory.beyond = if beyond { memory.beyond.saturating_add(1) } else { 0 };
        if memory.beyond >= BEYOND_SAMPLES {
            news.fault = Some(Fault::ErrorBound);
        }
        #[expect(clippy::cast_possible_truncation, reason = "a share for people")]
        let shown = share.to_f64() as f32;
        news.share = shown;
    }

    /// The sample with a torque that the drive can have given.
    ///
    /// # Method
    ///
    /// Between the least and the largest torque commanded lately, and half of the torque limit beyond either;
    /// where there is no limit, the outer loop's torque at 1 rad and twice what was commanded. A torque
    /// outside of it is replaced by the last command.
    #[inline]
    pub(crate) fn believed(
        &self,
        memory: &JointMemory<R>,
        m: &Measurement<R>,
        events: &mut Events,
    ) -> Measurement<R> {
        let [low, high] = memory.commanded;
        let slack = self.torque_slack + (high - low);
        if m.tau_applied <= high + slack && m.tau_applied >= low - slack {
            return *m;
        }
        *events |= Events::TORQUE_REFUSED;
        Measurement { tau_applied: memory.law.tau, ..*m }
    }
}

impl<R: Real> JointGains<R> {
    /// Largest deviation of a measured torque from the commanded one \[N·m\].
    pub(crate) fn torque_slack(&self) -> R {
        let limit = self.limits.torque();
        if limit.is_finite() { R::from_f64(TORQUE_SLACK) * limit } else { self.inertia * self.kp }
    }
}

impl<R: Real> JointMemory<R> {
    /// The torque that is commanded at this sample may act from now on; what was commanded long ago does not any more.
    #[inline]
    pub(crate) fn commands(&mut self) {
        let tau = self.law.tau;
        let share = R::from_f64(FORGOTTEN_SHARE);
        let [low, high] = &mut self.commanded;
        *low += share * (tau - *low);
        *high += share * (tau - *high);
        *low = if tau < *low { tau } else { *low };
        *high = if tau > *high { tau } else { *high };
    }
}
