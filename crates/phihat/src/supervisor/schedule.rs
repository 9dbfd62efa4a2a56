//! Start gains and running gains: which are in force, and how one set gives way to the other.

use super::memory::{ArmState, JointMemory};
use super::moment::ArmMoment;
use super::rules::JointRules;
use super::sample::Rules;
use crate::{Events, Form, JointGains, Measurement, Mode, Real, Reference};

/// Changes between start gains and running gains, all joints at once.
pub(crate) fn schedule<R: Real>(
    Rules { arm, joints: rules }: &Rules<'_, R>,
    state: &mut ArmState,
    memories: &mut [JointMemory<R>],
    fresh: bool,
    events: &mut Events,
) {
    let law = matches!(state.mode, Mode::Holding | Mode::Tracking);
    // Every joint is asked, without a branch: it costs less than to leave early.
    if !(law && fresh && rules.iter().fold(false, |any, rule| any | rule.scheduled)) {
        return;
    }
    let within = |limit: R| memories.iter().all(|m| m.mismatch_square <= limit * limit);
    let (settled, disturbed) = (within(arm.settled), !within(arm.disturbed));
    state.settled = if settled { state.settled.saturating_add(1) } else { 0 };
    state.disturbed = if disturbed { state.disturbed.saturating_add(1) } else { 0 };
    let raise = !state.raised && state.settled >= arm.dwell_samples;
    let lower = state.raised && state.disturbed >= arm.dwell_samples;
    if !(raise || lower) {
        return;
    }
    // All joints or none: tried on copies before.
    let change = |rule: &JointRules<R>, memory: &mut JointMemory<R>| {
        JointRules::change(memory, rule.in_force(state.raised), rule.in_force(raise))
    };
    if !rules.iter().zip(memories.iter()).all(|(rule, memory)| change(rule, &mut { *memory })) {
        return;
    }
    for (rule, memory) in rules.iter().zip(memories) {
        let _tried = change(rule, memory);
    }
    state.raised = raise;
    state.settled = 0;
    state.disturbed = 0;
    *events |= Events::RAISED.when(raise) | Events::LOWERED.when(lower);
}

impl<R: Real> JointRules<R> {
    /// Puts other gains in force, without a step in torque.
    pub(crate) fn exchange(
        &mut self,
        memory: &mut JointMemory<R>,
        gains: JointGains<R>,
        raised: bool,
    ) {
        let old = *self.in_force(raised);
        let start = if self.scheduled { self.gains[0] } else { gains };
        self.gains = [start, gains];
        self.range = self.range.map(|range| range.with_gains(&gains));
        self.stop = self.stop.with_gains(&gains);
        self.torque_slack = gains.torque_slack();
        let _held = Self::change(memory, &old, self.in_force(raised));
    }

    /// Changes gains without a step in torque: what the new ones demand differently at the next sample is
    /// faded out from there. The literal form's `φ̂` is handed over to the highest integral, and the lower ones begin
    /// at zero where the order rises. `false`, and nothing changes: no finite integral gives that `φ̂`.
    pub(crate) fn change(
        memory: &mut JointMemory<R>,
        from: &JointGains<R>,
        to: &JointGains<R>,
    ) -> bool {
        if to.knows_as(from) {
            // What a lower order does not have goes on for one sample more.
            let mut above = R::ZERO;
            for (j, entry) in memory.law.memory.iter_mut().enumerate().rev() {
                if j >= to.order {
                    above = *entry;
                    *entry = R::ZERO;
                } else if j + 1 == to.order {
                    *entry += to.period * above;
                }
            }
            // A law from positions starts from the torque that acts: it has nothing to fade out.
            if to.form != Form::Positions {
                memory.before = memory.before.or(Some([from.inertia, from.kd, from.kp]));
            }
        } else {
            let (m, r) = (memory.measured, memory.reference);
            let last = memory.law.tau;
            let tau = if to.form == Form::Positions {
                last
            } else {
                from.outer_loop(&m, &r) + memory.phi_hat()
            };
            if !to.resume(&mut memory.law, &m, &r, tau) {
                return false;
            }
            memory.law.tau = last;
            memory.unfed();
        }
        true
    }
}

impl<R: Real> JointMemory<R> {
    /// The mean mismatch `φ − φ̂`.
    pub(crate) fn learn(&mut self, gains: &JointGains<R>, m: &Measurement<R>, now: &ArmMoment<R>) {
        let interval = &now.interval;
        if interval.parts == 0 {
            return;
        }
        let rate = interval.share / interval.step;
        let phi = m.tau_applied - gains.inertia * (m.dq - self.measured.dq) * rate;
        let slow = now.average;
        let news = (phi - self.phi_hat()) - self.mismatch;
        self.mismatch = (self.mismatch + slow * news).snap();
        let more = self.mismatch * self.mismatch - self.mismatch_square;
        self.mismatch_square = (self.mismatch_square + slow * more).snap();
    }

    /// The first sample of other gains: what they demand differently is faded out from here.
    pub(crate) fn fade_from_old_gains(
        &mut self,
        gains: &JointGains<R>,
        m: &Measurement<R>,
        reference: &Reference<R>,
        rate: R,
    ) {
        if let Some([inertia, kd, kp]) = self.before.take() {
            let old = JointGains { inertia, kp, kd, ..*gains };
            let left = self.fading(rate);
            self.fade_out(left + old.outer_loop(m, reference) - gains.outer_loop(m, reference));
        }
    }
}
