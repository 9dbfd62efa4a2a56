//! One joint enters a mode.

use super::blend::Blend;
use super::memory::{JointMemory, whole};
use super::monitor::{Actuation, Oscillation};
use super::rules::JointRules;
use super::stopping::Stopping;
use crate::{Action, Braking, JointState, Measurement, Real, Reference};

impl<R: Real> JointRules<R> {
    /// Enters a mode.
    pub(crate) fn act(
        &self,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        action: Action,
        (preset, learnt): (Option<R>, bool),
        length: R,
    ) {
        let here = Reference::at_rest(m.q);
        match action {
            Action::None => {}
            Action::Capture => {
                memory.held = preset.unwrap_or(memory.held);
                // What a stop found out about the drive ends with it.
                memory.stopping = Stopping::default();
                // How far it went until now is nothing that a spring could answer.
                memory.measured = *m;
                memory.before_now = [memory.held; 2];
                memory.home = here.q;
                memory.reference = here;
            }
            Action::Engage => {
                memory.home = here.q;
                memory.reference = here;
                memory.blend = Blend::default();
                memory.braking = Braking::default();
                memory.beyond = 0;
                memory.fade_out(R::ZERO);
                memory.mismatch = R::ZERO;
                memory.mismatch_square = R::ZERO;
                memory.funnel_settled = 0;
                memory.funnel = self.funnel.map_or(R::ZERO, |f| f.excess);
                let tau = memory.law.tau;
                memory.law = JointState::new();
                let gains = self.in_force(false);
                // A law that takes positions alone begins at rest: a velocity would be a difference of two readings.
                let begins =
                    Measurement { dq: if gains.hears_velocity() { m.dq } else { R::ZERO }, ..*m };
                // The held torque becomes φ̂; what damping adds to it at this sample is the law's too.
                gains.resume(&mut memory.law, &begins, &here, memory.held);
                memory.law.tau = tau;
                memory.oscillation = Oscillation::restart(memory.held);
                memory.steady = memory.held;
                memory.before_now = [memory.held; 2];
                memory.actuation = Actuation::default();
            }
            Action::Follow => {
                memory.blend = Blend::new(&memory.reference, &memory.asked, length);
            }
            Action::Settle => {
                let at = memory.reference;
                let [square, linear] = self.stopping;
                let ahead = if self.shaper.is_some() {
                    at.dq * (square * at.dq.abs() + linear)
                } else {
                    R::from_f64(0.5) * at.dq * length
                };
                memory.home = at.q + ahead;
                let rest = Reference::at_rest(memory.home);
                memory.blend = Blend::new(&at, &rest, length);
            }
            Action::Stop => {
                // What holds the arm was known before what stops it now: `φ̂` may have learnt the latter.
                let [_, earlier] = memory.before_now;
                let known = if learnt { earlier } else { memory.steady };
                let wound = whole(known, memory.fed);
                // No torque beyond its limit held an arm: the literal form winds up against a push.
                memory.held = wound.saturate(self.running().limits.torque());
                let learns = !learnt || memory.held != wound;
                memory.stopping = Stopping { learns, ..Stopping::default() };
            }
            Action::Release => memory.held = R::ZERO,
        }
    }
}
