//! One sample of a whole arm.

use super::arrivals::{Arrival, interval};
use super::follow::{JointNews, Moment};
use super::memory::{ArmState, JointMemory};
use super::mode::next_mode;
use super::options::{ArmRules, JointRules};
use crate::{
    Action, Command, Events, Fault, Measurement, Mode, ModeEvents, ModeRequest, Real, Reference,
    Report, Stamp,
};

/// What the robot says at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a, R> {
    /// Which sample it is. Repeat the last one when none came.
    pub stamp: Stamp,
    /// Now \[ns\], by the clock of the stamp; only the age is taken from it.
    pub now_ns: u64,
    /// The joints, in the controller's order.
    pub joints: &'a [Measurement<R>],
}

/// What the caller wants at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request<'a, R> {
    /// Which mode.
    pub mode: ModeRequest,
    /// Where each joint shall be; heeded in [`Mode::Tracking`], and compared with the pose before.
    pub references: &'a [Reference<R>],
    /// Torques that hold the arm, heeded when it is armed; without them the torque of the last stop, or zero.
    pub preset: Option<&'a [R]>,
}

/// Answers one sample of an arm whose number of joints may be known at run time only.
///
/// The slices of rules, memories and commands belong together; joints beyond the shortest are left alone. A
/// sample or reference list of another length is refused like one that is not finite.
///
/// # What happens
///
/// 1. The sample is judged as a whole: fresh, finite, plausible. What fails changes no state but counters.
/// 2. Faults and the request go through [`next_mode`].
/// 3. The law, or what the mode asks for, gives a torque; range, rate and torque limits let it out.
///
/// Without a fresh sample the torque is held, after `hold_samples` it fades to `φ̂`, after `stop_samples`
/// the arm stops.
pub fn supervise<R: Real>(
    (arm, rules): (&ArmRules<R>, &[JointRules<R>]),
    (state, memories): (&mut ArmState, &mut [JointMemory<R>]),
    sample: &Sample<'_, R>,
    request: &Request<'_, R>,
    commands: &mut [Command<R>],
) -> Report {
    let mut events = Events::NONE;
    let arrival = admit(arm, rules, state, memories, sample, &mut events);
    ask(state, rules.len(), memories, request, &mut events);
    let seen = watch(arm, rules, state, memories, sample, arrival.fresh);
    let fault = state.pending.take().or(seen);
    if state.fault.is_none() && state.mode != Mode::Idle {
        state.fault = fault;
    }
    let facts = ModeEvents {
        request: request.mode,
        request_is_new: request.mode != state.request,
        fault: fault.is_some(),
        fresh: arrival.fresh,
        at_rest: sample.joints.iter().all(|m| m.dq.abs() <= arm.rest_velocity),
        start_matches: memories
            .iter()
            .all(|m| (m.asked.q - m.reference.q).abs() <= arm.start_mismatch_max),
    };
    let step = next_mode(state.mode, facts);
    state.request = request.mode;
    enter(state, step.mode, step.action);
    let answers = (sample, request, commands);
    events |= answer((arm, rules), (state, memories), answers, &arrival, step.action);
    schedule(arm, rules, state, memories, arrival.fresh, &mut events);
    let slow = facts.at_rest || !facts.fresh;
    let late = state.in_mode >= arm.stop_samples_max;
    let stopped = state.mode == Mode::SafeStop && (slow || late || state.misdriven());
    Report {
        mode: state.mode,
        fault: state.fault,
        refusal: step.refusal,
        events: events | Events::REFUSED.when(step.refusal.is_some()),
        brake: stopped || state.mode == Mode::Idle,
        misses: state.arrivals.misses,
        lost: state.arrivals.history.count_ones(),
    }
}

/// Every joint's torque in the mode that is now in force.
fn answer<R: Real>(
    (arm, rules): (&ArmRules<R>, &[JointRules<R>]),
    (state, memories): (&mut ArmState, &mut [JointMemory<R>]),
    (sample, request, commands): (&Sample<'_, R>, &Request<'_, R>, &mut [Command<R>]),
    arrival: &Arrival,
    action: Action,
) -> Events {
    let fresh = arrival.fresh;
    // The law starts at this sample: what happened before it is not its own.
    let elapsed = if action == Action::Engage { None } else { arrival.elapsed_ns };
    let now = Moment {
        interval: interval(elapsed, arm.arrivals.period_ns, arm.nominal()),
        reference_progress: R::from_f64(f64::from(state.blending)) * arm.blend_rate,
        blend: arm.blend,
        blend_rate: arm.blend_rate,
        tracking: state.mode == Mode::Tracking,
        raised: state.raised,
        first_motion: state.engaged < arm.first_motion_samples,
        dwell: arm.dwell_samples,
    };
    let mut events = Events::NONE;
    let joints = rules.iter().zip(memories.iter_mut()).zip(commands).enumerate();
    for (joint, ((rule, memory), command)) in joints {
        let measured = if fresh { sample.joints.get(joint).copied() } else { None };
        let m = measured.unwrap_or(memory.measured);
        if action != Action::None {
            let preset = request.preset.and_then(|p| p.get(joint)).copied();
            rule.act(memory, &m, action, preset.filter(|p| p.is_finite()), arm.blend);
        }
        let (answer, news) = match state.mode {
            Mode::Holding | Mode::Tracking if fresh => rule.follow(memory, &m, &now),
            Mode::Holding | Mode::Tracking => {
                rule.wait(memory, state.arrivals.misses > arm.hold_samples)
            }
            Mode::Armed | Mode::SafeStop => rule.rest(memory, &m, &arm.stop(state, fresh)),
            Mode::Idle => rule.free(memory, &m),
        };
        *command = answer;
        memory.measured = m;
        events |= news.events
            | Events::SATURATED.when(answer.status.saturated)
            | Events::RATE_LIMITED.when(answer.status.rate_limited);
        note(state, joint, news);
    }
    events
}

/// Judges the sample and counts it.
fn admit<R: Real>(
    arm: &ArmRules<R>,
    rules: &[JointRules<R>],
    state: &mut ArmState,
    memories: &[JointMemory<R>],
    sample: &Sample<'_, R>,
    events: &mut Events,
) -> Arrival {
    let active = !matches!(state.mode, Mode::Idle | Mode::SafeStop);
    let arrivals = &mut state.arrivals;
    let resync = !active;
    let mut arrival = arrivals.judge(&arm.arrivals, sample.now_ns, sample.stamp, resync);
    let known = arrivals.last.is_some() && !(resync && arrivals.misses > 0);
    if arrival.fresh {
        let finite = sample.joints.len() == rules.len()
            && sample.joints.iter().fold(true, |all, m| all & m.is_finite());
        let mut plausible = true;
        if finite {
            let elapsed = f64::from(arrivals.misses.saturating_add(2));
            let reach = arm.period * R::from_f64(elapsed);
            let joints = rules.iter().zip(memories).zip(sample.joints);
            for ((rule, memory), m) in joints {
                let step = (m.q - memory.measured.q).abs();
                plausible &= m.dq.abs() <= rule.velocity_max
                    && (!known || step <= rule.velocity_max * reach);
            }
        }
        arrival.events |= Events::NOT_FINITE.when(!finite) | Events::IMPLAUSIBLE.when(!plausible);
        arrival.fresh = finite && plausible;
        if !arrival.fresh {
            arrivals.missed(true);
        }
    } else {
        arrivals.missed(false);
    }
    if arrival.fresh {
        arrivals.took(sample.stamp);
    } else {
        arrival.elapsed_ns = None;
        arrival.events |= Events::MISSED;
    }
    *events |= arrival.events;
    arrival
}

/// Takes the caller's reference, if it is one.
fn ask<R: Real>(
    state: &mut ArmState,
    joints: usize,
    memories: &mut [JointMemory<R>],
    request: &Request<'_, R>,
    events: &mut Events,
) {
    let good = request.references.len() == joints
        && request.references.iter().fold(true, |all, r| all & r.is_finite());
    if good {
        for (memory, reference) in memories.iter_mut().zip(request.references) {
            memory.asked = *reference;
        }
        state.bad_references = 0;
    } else {
        for memory in memories {
            memory.asked = Reference { q: memory.asked.q, ..Reference::default() };
        }
        state.bad_references = state.bad_references.saturating_add(1);
        *events |= Events::REFERENCE_REFUSED;
    }
}

/// Everything that stops an arm and can be seen before the law runs.
fn watch<R: Real>(
    arm: &ArmRules<R>,
    rules: &[JointRules<R>],
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
    if arrivals.history.count_ones() > arm.lost_max {
        return Some((Fault::LinkQuality, 0));
    }
    if state.mode == Mode::Tracking && state.bad_references >= arm.stop_samples {
        return Some((Fault::BadReference, 0));
    }
    let mut fault = None;
    if fresh {
        let joints = rules.iter().zip(memories).zip(sample.joints).enumerate();
        for (joint, ((rule, memory), m)) in joints {
            let found = rule.watch(memory, m, arm.period, law);
            fault = fault.or(found.map(|fault| (fault, joint)));
        }
    }
    fault
}

/// Keeps the counters of a mode.
fn enter(state: &mut ArmState, mode: Mode, action: Action) {
    state.in_mode = if action == Action::None { state.in_mode.saturating_add(1) } else { 0 };
    state.engaged = state.engaged.saturating_add(1);
    state.blending = state.blending.saturating_add(1);
    match action {
        Action::Capture => state.fault = None,
        Action::Engage => {
            state.engaged = 0;
            state.raised = false;
            state.settled = 0;
            state.disturbed = 0;
        }
        Action::Follow | Action::Settle => state.blending = 0,
        _ => {}
    }
    state.mode = mode;
}

/// What the law noticed becomes a fault at the next sample.
fn note(state: &mut ArmState, joint: usize, news: JointNews) {
    let fault = if news.not_finite {
        Fault::NotFinite
    } else if news.wrong_way {
        Fault::Actuation
    } else if news.oscillates {
        Fault::Oscillation
    } else {
        return;
    };
    state.pending = state.pending.or(Some((fault, joint)));
}

/// Changes between start gains and running gains, all joints at once.
fn schedule<R: Real>(
    arm: &ArmRules<R>,
    rules: &[JointRules<R>],
    state: &mut ArmState,
    memories: &mut [JointMemory<R>],
    fresh: bool,
    events: &mut Events,
) {
    let law = matches!(state.mode, Mode::Holding | Mode::Tracking);
    if !(law && fresh && rules.iter().any(|rule| rule.start.is_some())) {
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
    for (rule, memory) in rules.iter().zip(memories) {
        JointRules::change(memory, rule.in_force(state.raised), rule.in_force(raise));
    }
    state.raised = raise;
    state.settled = 0;
    state.disturbed = 0;
    *events |= Events::RAISED.when(raise) | Events::LOWERED.when(lower);
}
