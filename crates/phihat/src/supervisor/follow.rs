//! One joint under supervision: its reference, its law, its torque.

use super::blend::Blend;
use super::memory::JointMemory;
use super::monitor::{Actuation, Oscillation};
use super::options::JointRules;
use crate::joint::Interval;
use crate::{
    Action, Command, Events, Form, JointGains, JointState, Measurement, Real, Reference, Status,
};

/// What one joint's sample brought.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct JointNews {
    pub(crate) events: Events,
    pub(crate) oscillates: bool,
    pub(crate) wrong_way: bool,
    pub(crate) not_finite: bool,
}

/// Where the arm stands, for every joint the same.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment<R> {
    pub(crate) interval: Interval<R>,
    /// Progress of the reference's blend, from 0; over at 1. Its length \[s\].
    pub(crate) reference_progress: R,
    pub(crate) blend: R,
    /// Progress per sample.
    pub(crate) blend_rate: R,
    pub(crate) tracking: bool,
    pub(crate) raised: bool,
    pub(crate) first_motion: bool,
    /// Samples that count as a while: 0.1 s or so.
    pub(crate) dwell: u32,
}

impl<R: Real> JointRules<R> {
    /// The gains in force.
    pub(crate) fn in_force(&self, raised: bool) -> &JointGains<R> {
        match &self.start {
            Some(start) if !raised => start,
            _ => &self.gains,
        }
    }

    /// Enters a mode.
    pub(crate) fn act(
        &self,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        action: Action,
        preset: Option<R>,
        length: R,
    ) {
        let here = Reference { q: m.q, ..Reference::default() };
        match action {
            Action::None => {}
            Action::Capture => {
                memory.held = preset.unwrap_or(memory.held);
                memory.home = here.q;
                memory.reference = here;
            }
            Action::Engage => {
                memory.home = here.q;
                memory.reference = here;
                memory.blend = Blend::default();
                memory.fade_out(R::ZERO);
                memory.mismatch = R::ZERO;
                memory.mismatch_square = R::ZERO;
                memory.funnel_settled = 0;
                memory.funnel = self.funnel.map_or(-R::from_f64(1.0), |f| f.excess);
                let tau = memory.law.tau;
                memory.law = JointState::new();
                // The held torque becomes φ̂; what damping adds to it at this sample is the law's too.
                self.in_force(false).resume(&mut memory.law, m, &here, memory.held);
                memory.law.tau = tau;
                memory.oscillation = Oscillation::restart(memory.held);
                memory.steady = memory.held;
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
                let rest = Reference { q: memory.home, ..Reference::default() };
                memory.blend = Blend::new(&at, &rest, length);
            }
            Action::Freeze => memory.held = memory.law.phi_hat,
            Action::Release => memory.held = R::ZERO,
        }
    }

    /// The reference in force.
    fn refer(&self, memory: &JointMemory<R>, now: &Moment<R>, events: &mut Events) -> Reference<R> {
        let base = if now.tracking {
            memory.asked
        } else {
            Reference { q: memory.home, ..Reference::default() }
        };
        let kept = self.keep(&base, events);
        if let Some(shaper) = &self.shaper {
            let shaped = shaper.step(&memory.reference, &kept);
            *events |= Events::SHAPED.when(shaped != kept);
            return shaped;
        }
        if now.reference_progress < R::from_f64(1.0) {
            let blended = memory.blend.at(now.reference_progress, now.blend, &kept);
            return self.keep(&blended, events);
        }
        kept
    }

    fn keep(&self, reference: &Reference<R>, events: &mut Events) -> Reference<R> {
        match self.range.as_ref().map(|range| range.keep(reference.q)) {
            Some((q, true)) => {
                *events |= Events::RANGE;
                Reference { q, ..Reference::default() }
            }
            _ => *reference,
        }
    }

    /// One fresh sample of the running law.
    pub(crate) fn follow(
        &self,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        now: &Moment<R>,
    ) -> (Command<R>, JointNews) {
        let mut news = JointNews::default();
        let gains = self.in_force(now.raised);
        let reference = self.refer(memory, now, &mut news.events);
        let before = memory.law;
        let mut next = gains.estimate(&before, m, &reference, now.interval);
        for entry in &mut next.memory {
            *entry = entry.snap();
        }
        let at_rest = reference.dq == R::ZERO;
        let error = m.q - reference.q;
        if at_rest && error.abs() < self.dead_zone {
            next.memory = before.memory;
            next.phi_hat = before.phi_hat;
            news.events |= Events::DEAD_ZONE;
        }
        if let Some(range) = &self.range
            && gains.form == Form::Observer
        {
            let [first, ..] = &mut next.memory;
            *first = range.freeze(m.q, before.phi_hat, *first);
            next.phi_hat = *first;
        }
        self.learn(memory, gains, &before, m, now);
        let mut demand = gains.outer_loop(m, &reference) + next.phi_hat;
        demand = self.funnel(memory, gains, m, &reference, demand, now, &mut news.events);
        if let Some([inertia, kd, kp]) = memory.before.take() {
            let old = JointGains { inertia, kp, kd, ..*gains };
            let left = memory.fading(now.blend_rate);
            memory.fade_out(left + old.outer_loop(m, &reference) - gains.outer_loop(m, &reference));
        }
        demand += memory.fading(now.blend_rate);
        if self.oscillation.is_finite() {
            news.oscillates = memory.oscillation.take(demand, self.oscillation);
        }
        memory.steady += R::from_f64(0.02) * (next.phi_hat - memory.steady);
        if now.first_motion {
            let step = m.dq - memory.measured.dq;
            let gain = R::from_f64(0.05) * gains.inertia_inverse * now.interval.step;
            news.wrong_way = memory.actuation.take(m.tau_applied, step, gain, self.first_motion);
        }
        memory.reference = reference;
        let command = self.out(memory, next, m, demand, &mut news);
        (command, news)
    }

    /// The mean mismatch `φ − φ̂`.
    fn learn(
        &self,
        memory: &mut JointMemory<R>,
        gains: &JointGains<R>,
        before: &JointState<R>,
        m: &Measurement<R>,
        now: &Moment<R>,
    ) {
        if self.start.is_some() && now.interval.parts > 0 {
            let rate = now.interval.share / now.interval.step;
            let phi = m.tau_applied - gains.inertia * (m.dq - memory.measured.dq) * rate;
            let slow = R::from_f64(0.02);
            let news = (phi - before.phi_hat) - memory.mismatch;
            memory.mismatch = (memory.mismatch + slow * news).snap();
            let more = memory.mismatch * memory.mismatch - memory.mismatch_square;
            memory.mismatch_square = (memory.mismatch_square + slow * more).snap();
        }
    }

    /// The demand inside a funnel, while there is one; the law's demand otherwise.
    #[allow(clippy::too_many_arguments, reason = "one call, all of it needed")]
    fn funnel(
        &self,
        memory: &mut JointMemory<R>,
        gains: &JointGains<R>,
        m: &Measurement<R>,
        reference: &Reference<R>,
        law: R,
        now: &Moment<R>,
        events: &mut Events,
    ) -> R {
        let Some(funnel) = &self.funnel else { return law };
        if memory.funnel < R::ZERO {
            return law;
        }
        *events |= Events::FUNNEL;
        let one = R::from_f64(1.0);
        let width = funnel.width + memory.funnel;
        memory.funnel = (memory.funnel * funnel.factor).snap();
        let e = m.q - reference.q;
        let de = m.dq - reference.dq;
        let share = e / width;
        let most = one + gains.alpha[0] / gains.kd;
        let room = one - share * share;
        *events |= Events::FUNNEL_LEFT.when(room <= R::ZERO);
        let g = if room * most > one { one / room } else { most };
        let demand = gains.inertia * (reference.ddq - g * (gains.kd * de + g * gains.kp * e));
        let narrow = memory.funnel < R::from_f64(0.05) * funnel.width;
        memory.funnel_settled = if narrow { memory.funnel_settled.saturating_add(1) } else { 0 };
        if memory.funnel_settled >= now.dwell {
            // Handed over: what the law demands differently is faded out.
            memory.funnel = -one;
            memory.fade_out(demand - law);
            *events |= Events::FUNNEL_OVER;
        }
        demand
    }

    /// The only way out: joint range, torque rate, torque; finite always.
    pub(crate) fn out(
        &self,
        memory: &mut JointMemory<R>,
        mut next: JointState<R>,
        m: &Measurement<R>,
        demand: R,
        news: &mut JointNews,
    ) -> Command<R> {
        let mut demand = demand;
        if let Some(range) = &self.range {
            let law = (next.phi_hat, self.gains.inertia, self.gains.kd);
            let limits = &self.gains.limits;
            // Time to shed one N·m, 0 without a rate limit.
            let shed = self.gains.period / limits.step();
            let (capped, acted) = range.cap(m.q, m.dq, law, (demand, memory.law.tau, shed));
            demand = capped;
            news.events |= Events::RANGE.when(acted);
        }
        if !(demand.is_finite() && next.phi_hat.is_finite()) {
            news.not_finite = true;
            return memory.law.hold();
        }
        let limited = self.gains.limits.apply(demand, memory.law.tau);
        next.tau = limited.tau;
        memory.law = next;
        let status = Status {
            saturated: limited.over_torque,
            rate_limited: limited.over_rate,
            refused: false,
        };
        Command { tau: next.tau, phi_hat: next.phi_hat, status }
    }

    /// Changes gains without a step in torque: what the new ones demand differently at the next sample is
    /// faded out from there.
    pub(crate) fn change(memory: &mut JointMemory<R>, from: &JointGains<R>, to: &JointGains<R>) {
        if to.form == Form::Observer && from.form == Form::Observer {
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
            memory.before = memory.before.or(Some([from.inertia, from.kd, from.kp]));
        } else {
            let (m, r) = (memory.measured, memory.reference);
            let tau = from.outer_loop(&m, &r) + memory.law.phi_hat;
            let last = memory.law.tau;
            to.resume(&mut memory.law, &m, &r, tau);
            memory.law.tau = last;
        }
    }
}
