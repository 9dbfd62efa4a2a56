//! One joint under supervision: its reference, its law, its torque.

use super::feed::LawInputs;
use super::memory::{JointMemory, whole};
use super::moment::{Aim, ArmMoment};
use super::monitor::SUSPICIOUS_SAMPLES;
use super::rules::JointRules;
use crate::estimate::Estimate;
use crate::gains::Built;
use crate::{Command, Events, Fault, Form, JointGains, Measurement, Real, Reference};

/// Share of the nominal joint's acceleration that a joint has to show at first motion: a load of twenty times the
/// nominal inertia still does, a dead drive or a closed brake does not.
pub(crate) const LEAST_ACCELERATION: f64 = 0.05;

/// Events and fault of one joint's sample.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct JointNews {
    pub(crate) events: Events,
    /// Fault that stops the arm at the next sample.
    pub(crate) fault: Option<Fault>,
    /// Measured error as a share of its bound.
    pub(crate) share: f32,
}

impl<R: Real> JointRules<R> {
    /// One fresh sample of the running law, which is built as `S`.
    #[allow(clippy::inline_always, reason = "a call each would cost a hundred instructions")]
    #[inline(always)]
    pub(crate) fn follow<S: Built>(
        &self,
        gains: &JointGains<R>,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        now: &ArmMoment<R>,
    ) -> (Command<R>, JointNews) {
        let mut news = JointNews::default();
        let m = &self.believed(memory, m, &mut news.events);
        if now.stops() && !memory.stopping.begun {
            self.begin_to_stop(gains, memory, m, now);
        }
        let reference = self.refer(memory, now, &mut news.events);
        if self.bound_inverse > R::ZERO && !now.stops() {
            self.compare_with_bound(memory, m.q - reference.q, &mut news);
        }
        let told = match S::FORM {
            Form::Observer | Form::Literal => LawInputs::bare(&reference),
            Form::Positions => memory.tell(gains, &reference, now),
        };
        let next = self.know::<S>(memory, gains, m, &told, now, &mut news.events);
        if self.scheduled {
            memory.learn(gains, m, now);
        }
        let law = gains.demand::<S>(&next, m, &told.reference);
        let mut demand = match &self.funnel {
            Some(funnel) if !now.stops() => {
                funnel.demand(memory, gains, m, &reference, law, now, &mut news.events)
            }
            _ => law,
        };
        if memory.before.is_some() {
            memory.fade_from_old_gains(gains, m, &reference, now.blend_rate);
        }
        demand += memory.fading(now.blend_rate);
        if S::FILTERED {
            demand = gains.low_passed(demand, memory.law.tau);
        }
        if now.stops() {
            demand = self.without_driving(memory, m, (demand, next.phi_hat), now, &mut news);
            demand = self.probed(memory, gains, m, demand, &mut news);
        }
        news.fault = news.fault.or(self.monitor(memory, gains, m, demand, now));
        let phi_hat = whole(next.phi_hat, told.fed);
        memory.steady += now.average * (next.phi_hat - memory.steady);
        memory.reference = reference;
        let command = self.out(memory, phi_hat, m, demand, &mut news);
        if !command.status.refused {
            memory.law.phi_hat = next.phi_hat;
            memory.fed = told.fed;
            JointGains::remember::<S>(&mut memory.law, &next, m);
        }
        let at_limit = command.status.saturated;
        memory.saturated = if at_limit { memory.saturated.saturating_add(1) } else { 0 };
        if memory.saturated >= now.saturation {
            news.fault = news.fault.or(Some(Fault::Saturation));
        }
        (command, news)
    }

    /// The reference in force.
    #[allow(clippy::inline_always, reason = "one copy per form of the law, each without a call")]
    #[inline(always)]
    fn refer(
        &self,
        memory: &mut JointMemory<R>,
        now: &ArmMoment<R>,
        events: &mut Events,
    ) -> Reference<R> {
        if now.stops() {
            return self.stopping_reference(memory);
        }
        let base =
            if now.aim == Aim::Track { memory.asked } else { Reference::at_rest(memory.home) };
        let kept = self.keep(base, events);
        if let Some(shaper) = &self.shaper {
            let shaped = match &self.boxed {
                Some(boxed) => boxed.step(&memory.reference, &kept, &mut memory.braking),
                None => shaper.step(&memory.reference, &kept),
            };
            *events |= Events::SHAPED.when(shaped != kept);
            return shaped;
        }
        if now.reference_progress < R::from_f64(1.0) {
            let blended = memory.blend.at(now.reference_progress, now.blend, &kept);
            return self.keep(blended, events);
        }
        kept
    }

    fn keep(&self, reference: Reference<R>, events: &mut Events) -> Reference<R> {
        match self.range.as_ref().and_then(|range| range.keep(reference.q)) {
            Some(q) => {
                *events |= Events::RANGE;
                Reference::at_rest(q)
            }
            None => reference,
        }
    }

    /// Estimate after this sample: unchanged in the dead zone, not grown outward in a soft zone.
    fn know<S: Built>(
        &self,
        memory: &JointMemory<R>,
        gains: &JointGains<R>,
        m: &Measurement<R>,
        told: &LawInputs<R>,
        now: &ArmMoment<R>,
        events: &mut Events,
    ) -> Estimate<R> {
        let reference = &told.reference;
        let before = &memory.law;
        let mut next = gains.estimate::<S>(before, m, reference, &now.interval);
        for entry in &mut next.memory {
            *entry = entry.snap();
        }
        if (m.q - reference.q).abs() < self.dead_zone && reference.dq == R::ZERO {
            next.memory = before.memory;
            next.phi_hat = before.phi_hat;
            *events |= Events::DEAD_ZONE;
        }
        if let Some(range) = &self.range {
            if S::FORM != Form::Literal {
                let [first, ..] = &mut next.memory;
                *first = range.freeze(m.q, before.phi_hat - told.more, *first);
                next.phi_hat = *first;
            }
        }
        next
    }

    /// Monitors the oscillation of the demand, and at first motion the response to the torque.
    #[allow(clippy::inline_always, reason = "saves twenty instructions of a sample of 7 joints")]
    #[inline(always)]
    fn monitor(
        &self,
        memory: &mut JointMemory<R>,
        gains: &JointGains<R>,
        m: &Measurement<R>,
        demand: R,
        now: &ArmMoment<R>,
    ) -> Option<Fault> {
        let mut fault = None;
        if let Some(most) = self.oscillation {
            if memory.oscillation.take(demand, most) {
                fault = Some(Fault::Oscillation);
            }
        }
        if now.first_motion && !now.stops() {
            fault =
                fault.or(self.actuates(memory, gains, m, (R::from_f64(1.0), SUSPICIOUS_SAMPLES)));
        }
        fault
    }

    /// Returns [`Fault::Actuation`] if the joint does not accelerate the way the torque pushes.
    pub(crate) fn actuates(
        &self,
        memory: &mut JointMemory<R>,
        gains: &JointGains<R>,
        m: &Measurement<R>,
        (share, samples): (R, u32),
    ) -> Option<Fault> {
        let excitation = share * self.first_motion?;
        let step = m.dq - memory.measured.dq;
        let gain = R::from_f64(LEAST_ACCELERATION) * gains.inertia_inverse * gains.period;
        memory
            .actuation
            .take((m.tau_applied, step), gain, (excitation, samples))
            .then_some(Fault::Actuation)
    }

    /// The only way out: joint range, torque rate, torque; finite always.
    #[allow(clippy::inline_always, reason = "one copy per form of the law, each without a call")]
    #[inline(always)]
    pub(crate) fn out(
        &self,
        memory: &mut JointMemory<R>,
        phi_hat: R,
        m: &Measurement<R>,
        demand: R,
        news: &mut JointNews,
    ) -> Command<R> {
        let mut demand = demand;
        if let Some(range) = &self.range {
            if let Some(capped) = range.cap(m.q, m.dq, phi_hat, demand, memory.law.tau) {
                demand = capped;
                news.events |= Events::RANGE;
            }
        }
        if !(demand + phi_hat).is_finite() {
            news.fault = Some(Fault::NotFinite);
            return memory.hold();
        }
        let limited = self.running().limits.apply(demand, memory.law.tau);
        memory.law.tau = limited.tau;
        memory.commands();
        limited.command(phi_hat)
    }
}
