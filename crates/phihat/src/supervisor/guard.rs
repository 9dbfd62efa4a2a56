//! The guard: what is let in, and what stops an arm before the law runs.

use super::arrivals::SampleArrival;
use super::memory::{ArmState, JointMemory, Trust};
use super::sample::{Request, Rules, Sample};
use crate::{Events, Fault, Mode, Real, Reference};

/// Periods that a joint may have moved for, beyond those of the samples missed: the one since the last sample, and one
/// by which either stamp may be off.
const PERIODS_BESIDES_MISSED: u32 = 2;

/// Samples missed in a row, after which a stopped arm may be as fast as it will \[samples\].
const LONG_SAMPLES: u32 = 100;

/// Judges the sample and counts it.
pub(crate) fn admit<R: Real>(
    Rules { arm, joints: rules }: &Rules<'_, R>,
    state: &mut ArmState,
    memories: &[JointMemory<R>],
    sample: &Sample<'_, R>,
    events: &mut Events,
) -> SampleArrival {
    let active = !matches!(state.mode, Mode::Idle | Mode::SafeStop);
    let arrivals = &mut state.arrivals;
    let resync = !active;
    let mut arrival = arrivals.judge(&arm.arrivals, sample.now_ns, sample.stamp, resync);
    let known = arrivals.last.is_some() && !(resync && arrivals.misses > 0);
    if arrival.fresh {
        let periods = f64::from(arrivals.misses.saturating_add(PERIODS_BESIDES_MISSED));
        // As long as a joint can have moved since the last sample that was believed.
        let elapsed = arm.period * R::from_f64(periods);
        let reach = if known { elapsed } else { R::from_f64(f64::INFINITY) };
        // Whatever an arm does that was not seen for long, it is to be stopped.
        let long = !known && arrivals.misses > LONG_SAMPLES;
        let (mut doubt, mut plausible, mut jumped) = (R::ZERO, true, 0_u32);
        for ((rule, memory), m) in rules.iter().zip(memories).zip(sample.joints) {
            doubt += m.doubt();
            let step = (m.q - memory.measured.q).abs();
            // What was fast already may be faster now: that is a fault to act on, not a sample to refuse.
            let twice = R::from_f64(2.0) * memory.measured.dq.abs();
            let fastest = if twice > rule.velocity_max { twice } else { rule.velocity_max };
            let possible = long || m.dq.abs() <= fastest && step <= fastest * reach;
            plausible &= possible;
            jumped += u32::from(step > fastest * elapsed);
        }
        let stops = state.mode == Mode::SafeStop;
        // Positions of several joints that jump at once may be in another order.
        plausible &= long || !(stops && jumped > 1);
        let finite = doubt == R::ZERO && sample.joints.len() == rules.len();
        let plausible = plausible || !finite;
        arrival.events |= Events::NOT_FINITE.when(!finite) | Events::IMPLAUSIBLE.when(!plausible);
        arrival.fresh = finite && plausible;
        if arrival.fresh && stops && jumped > 0 {
            state.regains = Trust::Damper;
            if jumped > 1 {
                state.trust = state.trust.min(Trust::Held);
            }
        }
        if !arrival.fresh {
            arrivals.missed(true);
        }
    } else {
        arrivals.missed(false);
    }
    if arrival.fresh {
        arrivals.took(sample.stamp, arrival.events.contains(Events::TIME_JUMP));
    } else {
        arrival.elapsed_ns = None;
        arrival.events |= Events::MISSED;
    }
    *events |= arrival.events;
    arrival
}

/// Takes the caller's reference and feed-forward, where they are.
pub(crate) fn ask<R: Real>(
    state: &mut ArmState,
    joints: usize,
    memories: &mut [JointMemory<R>],
    request: &Request<'_, R>,
    events: &mut Events,
) {
    let mut fed_good = true;
    if let Some(fed) = request.feed_forward {
        let doubt = fed.iter().fold(R::ZERO, |sum, fed| sum + R::doubt([*fed]));
        fed_good = doubt == R::ZERO && fed.len() == joints;
        if fed_good {
            state.feeds = true;
            for (memory, fed) in memories.iter_mut().zip(fed) {
                memory.fed_asked = *fed;
            }
        }
    } else {
        state.feeds = false;
    }
    let doubt = request.references.iter().fold(R::ZERO, |sum, r| sum + r.doubt());
    let good = doubt == R::ZERO && request.references.len() == joints;
    if good {
        for (memory, reference) in memories.iter_mut().zip(request.references) {
            memory.asked = *reference;
        }
    } else {
        for memory in memories {
            memory.asked = Reference::at_rest(memory.asked.q);
        }
    }
    if good && fed_good {
        state.bad_references = 0;
    } else {
        state.bad_references = state.bad_references.saturating_add(1);
        *events |= Events::REFERENCE_REFUSED;
    }
}

/// Everything that stops an arm and can be seen before the law runs.
pub(crate) fn watch<R: Real>(
    Rules { arm, joints: rules }: &Rules<'_, R>,
    state: &ArmState,
    memories: &mut [JointMemory<R>],
    sample: &Sample<'_, R>,
    fresh: bool,
) -> Option<(Fault, usize)> {
    let arrivals = &state.arrivals;
    let law = matches!(state.mode, Mode::Holding | Mode::Tracking);
    if arrivals.bad >= arm.bad_samples {
        return Some((Fault::BadSample, 0));
    }
    if arrivals.misses >= arm.stop_samples {
        return Some((Fault::LinkLost, 0));
    }
    if arrivals.lost() > arm.lost_max {
        return Some((Fault::LinkQuality, 0));
    }
    if arrivals.wrong_times() > arm.clock_max {
        return Some((Fault::Clock, 0));
    }
    if state.mode == Mode::Tracking && state.bad_references >= arm.stop_samples {
        return Some((Fault::BadReference, 0));
    }
    let mut fault = None;
    if fresh {
        let joints = rules.iter().zip(memories).zip(sample.joints).enumerate();
        for (joint, ((rule, memory), m)) in joints {
            if let Some(found) = rule.watch(memory, m, arm.period, law) {
                fault = fault.or(Some((found, joint)));
            }
        }
    }
    fault
}
