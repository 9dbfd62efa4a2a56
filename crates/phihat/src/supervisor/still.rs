//! One joint when the law does not run: waiting, held, free; and what stops it.

use super::follow::JointNews;
use super::memory::{ArmState, JointMemory};
use super::monitor::Frozen;
use super::rules::{ArmRules, JointRules};
use crate::{Command, Fault, JointState, Measurement, Mode, Real};

/// Share of the damping in a stop that is left where velocity feedback may be what shakes the arm: a joint of
/// a quarter of the nominal inertia then sees no more of it than the nominal one does otherwise.
const SHAKEN_DAMPING: f64 = 0.25;

/// Share of the reference's velocity at which a joint has to move for its sensor to be called frozen: the rest may be
/// error, load and friction.
const FOLLOWED_SHARE: f64 = 0.2;

/// What a missed sample leaves of the feedback torque, once it fades to `φ̂`. Per missed sample, as `hold_samples` and
/// `stop_samples` around it are counted: between the defaults of 5 and 20, 4 % of it are left when the arm stops, at any
/// rate.
const FADE_PER_MISS: f64 = 0.8;

/// How a joint rests.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rest<R> {
    /// Share of `K_d` that damps.
    damping: R,
    /// Share of the held torque that is still there.
    held: R,
    /// `φ̂` itself shakes: hold its mean.
    steady: bool,
}

impl<R: Real> ArmRules<R> {
    /// How joints rest at this sample: the torque fades where there is no measurement for long, and goes at
    /// once where the drive does not do what it is told.
    pub(crate) fn stop(&self, state: &ArmState, fresh: bool) -> Rest<R> {
        let one = R::from_f64(1.0);
        let mut rest = Rest { damping: self.stop_damping, held: one, steady: false };
        if !fresh || state.misdriven() {
            rest.damping = R::ZERO;
        } else if state.shaking() {
            rest.damping = R::from_f64(SHAKEN_DAMPING) * rest.damping;
        }
        rest.steady = state.shaking();
        if state.mode == Mode::SafeStop && state.misdriven() {
            rest.held = R::ZERO;
        } else if state.mode == Mode::SafeStop && state.arrivals.misses >= self.stop_samples {
            let late = state.in_mode.saturating_sub(self.stop_samples_max);
            let gone = R::from_f64(f64::from(late)) * self.blend_rate;
            rest.held = if gone < one { one - gone } else { R::ZERO };
        }
        rest
    }
}

impl<R: Real> JointRules<R> {
    /// What this joint's sample says about faults.
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

    /// No fresh sample: the last torque, or after a while `φ̂` alone, with what was fed forward last.
    pub(crate) fn wait(&self, memory: &mut JointMemory<R>, long: bool) -> (Command<R>, JointNews) {
        let mut news = JointNews::default();
        if !long {
            return (memory.hold(), news);
        }
        let (phi_hat, measured) = (memory.phi_hat(), memory.measured);
        let feedback = memory.law.tau - phi_hat;
        let demand = phi_hat + R::from_f64(FADE_PER_MISS) * feedback;
        let mut command = self.out(memory, phi_hat, &measured, demand, &mut news);
        command.status.refused = true;
        (command, news)
    }

    /// The held torque, damped.
    pub(crate) fn rest(
        &self,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        rest: &Rest<R>,
    ) -> (Command<R>, JointNews) {
        let mut news = JointNews::default();
        if rest.steady {
            memory.held = memory.steady;
        }
        let phi_hat = memory.held * rest.held;
        let gains = self.running();
        let damping = gains.inertia * gains.kd * rest.damping;
        // A velocity that is frozen would drive the joint instead of damping it.
        let before = &memory.measured;
        let alive = (m.q - before.q).abs() > R::ZERO || (m.dq - before.dq).abs() > R::ZERO;
        let velocity = if alive { m.dq } else { R::ZERO };
        let demand = phi_hat - damping * velocity;
        let command = self.out(memory, phi_hat, m, demand, &mut news);
        if !command.status.refused {
            memory.law.phi_hat = phi_hat;
        }
        (command, news)
    }

    /// No torque, as fast as the rate limit allows; nothing is remembered but that.
    pub(crate) fn free(
        &self,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
    ) -> (Command<R>, JointNews) {
        let limited = self.running().limits.apply(R::ZERO, memory.law.tau);
        memory.law = JointState::new();
        memory.law.tau = limited.tau;
        memory.home = m.q;
        memory.reference.q = m.q;
        (limited.command(R::ZERO), JointNews::default())
    }
}
