//! One joint when the law does not run: waiting, held, free.

use super::follow::JointNews;
use super::memory::{ArmState, JointMemory, Trust};
use super::rules::{ArmRules, JointRules};
use crate::{Command, JointState, Measurement, Mode, Real};

/// Share of the damping in a stop that is left where velocity feedback may be what shakes the arm: a joint of
/// a quarter of the nominal inertia then sees no more of it than the nominal one does otherwise.
const SHAKEN_DAMPING: f64 = 0.25;

/// Share of the feedback torque that is left after a missed sample, once it fades to `φ̂`. Per missed sample,
/// as `hold_samples` and `stop_samples` around it are counted: between the defaults of 5 and 20, 4 % of it
/// are left when the arm stops, at any rate.
const FADE_PER_MISS: f64 = 0.8;

/// Damping, spring and holding torque of a joint while the law does not run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rest<R> {
    /// Share of `K_d` that damps.
    damping: R,
    /// True if a spring acts as well.
    spring: bool,
    /// Share of the held torque that is still there.
    held: R,
    /// True while so few samples in a row are missed that the last torque is held.
    hold: bool,
    /// True if the caller gives a feed-forward.
    feeds: bool,
}

impl<R: Real> ArmRules<R> {
    /// Damping and holding torque at this sample: the torque fades where there is no measurement for long,
    /// and is zero at once where the drive does not follow its command.
    pub(crate) fn stop(&self, state: &ArmState, fresh: bool) -> Rest<R> {
        let one = R::from_f64(1.0);
        let hold = state.arrivals.misses <= self.hold_samples;
        let blind = state.arrivals.misses >= self.stop_samples || state.trust == Trust::Held;
        let spring = state.trust >= Trust::Spring;
        let (damping, feeds) = (self.stop_damping, state.feeds);
        let mut rest = Rest { damping, spring, held: one, hold, feeds };
        if !fresh || state.trust <= Trust::Held {
            rest.damping = R::ZERO;
        } else if state.trust == Trust::Spring {
            rest.damping = R::from_f64(SHAKEN_DAMPING) * rest.damping;
        }
        if state.mode == Mode::SafeStop && state.trust == Trust::Nothing {
            rest.held = R::ZERO;
            rest.feeds = false;
        } else if state.mode == Mode::SafeStop && blind {
            let late = state.in_mode.saturating_sub(self.stop_samples_max);
            let gone = R::from_f64(f64::from(late)) * self.blend_rate;
            rest.held = if gone < one { one - gone } else { R::ZERO };
        }
        rest
    }
}

impl<R: Real> JointRules<R> {
    /// No fresh sample: the last torque, or after a while `φ̂` alone, with what was fed forward last.
    pub(crate) fn wait(&self, memory: &mut JointMemory<R>, long: bool) -> (Command<R>, JointNews) {
        if !long {
            return (memory.hold(), JointNews::default());
        }
        let known = memory.phi_hat();
        self.towards(memory, known)
    }

    /// The torque that held the arm before, with a damper and a spring.
    pub(crate) fn rest(
        &self,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        rest: &Rest<R>,
    ) -> (Command<R>, JointNews) {
        let mut news = JointNews::default();
        let gains = self.running();
        let rate = gains.kd * rest.damping;
        let damping = gains.inertia * rate;
        let before = memory.measured;
        let moved = m.q - before.q;
        // A spring, so that the joint does not creep; a joint of a quarter of the nominal inertia and more
        // does not swing on it.
        if rest.spring {
            let spring = R::from_f64(0.25) * rate * damping;
            memory.held = (memory.held - spring * moved).saturate(gains.limits.torque());
        }
        let fed = if rest.feeds { memory.fed_asked } else { R::ZERO };
        let phi_hat = fed + (memory.held - fed) * rest.held;
        // A velocity that is frozen, or left over from a jump, would drive the joint instead of damping it:
        // what the positions say as well counts.
        let gone = moved / gains.period;
        let velocity = if gone * m.dq > R::ZERO {
            if m.dq.abs() < R::from_f64(2.0) * gone.abs() { m.dq } else { gone }
        } else {
            R::ZERO
        };
        let damped = (damping * velocity).saturate(self.stop.unloaded_at(velocity));
        let mut demand = phi_hat - damped;
        if rest.spring && rest.damping > R::ZERO {
            demand = self.probed(memory, gains, m, demand, &mut news);
        }
        let command = self.out(memory, phi_hat, m, demand, &mut news);
        if !command.status.refused {
            memory.take_over_feed();
            memory.law.phi_hat = phi_hat;
        }
        (command, news)
    }

    /// A stop without a fresh sample: the last torque for a few samples, then the torque that held the arm before.
    pub(crate) fn stop_blind(
        &self,
        memory: &mut JointMemory<R>,
        rest: &Rest<R>,
    ) -> (Command<R>, JointNews) {
        if rest.hold {
            return (memory.hold(), JointNews::default());
        }
        // Whatever comes next finds another arm.
        memory.stopping.begun = false;
        let fed = if rest.feeds { memory.fed_asked } else { R::ZERO };
        let known = fed + (memory.held - fed) * rest.held;
        let answer = self.towards(memory, known);
        memory.take_over_feed();
        memory.law.phi_hat = answer.0.phi_hat;
        answer
    }

    /// Fades the rest of the feedback to a known torque.
    fn towards(&self, memory: &mut JointMemory<R>, known: R) -> (Command<R>, JointNews) {
        let mut news = JointNews::default();
        let measured = memory.measured;
        let feedback = memory.law.tau - known;
        let demand = known + R::from_f64(FADE_PER_MISS) * feedback;
        let mut command = self.out(memory, known, &measured, demand, &mut news);
        command.status.refused = true;
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
