//! One sample of a whole arm.

use super::arrivals::{SampleArrival, interval};
use super::follow::JointNews;
use super::guard::{admit, ask, watch};
use super::memory::{ArmState, JointMemory, Trust};
use super::mode::next_mode;
use super::moment::{Aim, ArmMoment};
use super::rules::{ArmRules, JointRules};
use super::sample::{Memories, Request, Rules, Sample};
use super::schedule::schedule;
use crate::gains::{AsLiteral, AsObserver, Built, Filtered, FromPositions, Path};
use crate::{
    Action, Command, Events, Form, JointGains, Measurement, Mode, ModeEvents, Real, Report,
};

/// Judges one sample and computes the torques of an arm, whose number of joints may be known at run time only.
///
/// The slices of rules, memories and commands belong together; joints beyond the shortest are left alone. A
/// sample, reference or feed-forward list of another length is refused like one that is not finite or beyond
/// ±2³² (4.3e9).
///
/// # What happens
///
/// 1. The sample is judged as a whole: fresh, finite, plausible. What fails changes no state but counters.
/// 2. Faults and the request go through [`next_mode`].
/// 3. The law, or what the mode asks for, gives a torque; range, rate and torque limits let it out.
///
/// Without a fresh sample the torque is held, after `hold_samples` it fades to `φ̂` (with what was fed
/// forward last), after `stop_samples` the arm stops. In a stop the law brings the arm to rest and holds it
/// there; without measurements the torque goes to what held the arm before.
pub fn supervise<R: Real>(
    rules: Rules<'_, R>,
    memories: Memories<'_, R>,
    sample: &Sample<'_, R>,
    request: &Request<'_, R>,
    commands: &mut [Command<R>],
) -> Report {
    let Rules { arm, joints } = rules;
    let Memories { arm: state, joints: memories } = memories;
    let mut events = Events::NONE;
    state.error_share = 0.0;
    let arrival = admit(&rules, state, memories, sample, &mut events);
    ask(state, joints.len(), memories, request, &mut events);
    let seen = watch(&rules, state, memories, sample, arrival.fresh);
    let fault = state.pending.take().or(seen);
    if state.mode != Mode::Idle {
        state.fault = state.fault.or(fault);
        let leaves = fault.map_or(Trust::Law, |(fault, _)| fault.leaves());
        state.trust = state.trust.min(leaves);
    }
    let at_rest = || sample.joints.iter().all(|m| m.dq.abs() <= arm.rest_velocity);
    let starts_here =
        |m: &JointMemory<R>| (m.asked.q - m.reference.q).abs() <= arm.start_mismatch_max;
    // What no way out of the present mode asks for is not looked at.
    let still = matches!(state.mode, Mode::Idle | Mode::SafeStop);
    let facts = ModeEvents {
        request: request.mode,
        request_is_new: request.mode != state.request,
        fault: fault.is_some(),
        fresh: arrival.fresh,
        at_rest: still && at_rest(),
        start_matches: state.mode == Mode::Holding && memories.iter().all(starts_here),
        outside_box: state.mode == Mode::Armed && is_outside(joints, sample),
    };
    let step = next_mode(state.mode, facts);
    state.request = request.mode;
    enter(state, step.mode, step.action);
    if step.action != Action::None {
        let learnt = state.fault.is_some_and(|(fault, _)| fault.is_learnt());
        act(&rules, memories, (sample, request), (arrival.fresh, learnt), step.action);
    }
    remember_before(arm, state, memories);
    let gap = after_a_gap(arm, state, memories, sample);
    believe_again(arm, state, memories, sample, arrival.fresh);
    let known = arrival.fresh && !(gap && state.mode == Mode::SafeStop);
    events |= if known && arm.law_runs(state) {
        let now = moment(arm, state, &arrival, step.action);
        run(joints, Memories { arm: state, joints: memories }, &now, sample, commands)
    } else {
        let fresh = (arrival.fresh, known);
        rest(&rules, Memories { arm: state, joints: memories }, sample, fresh, commands)
    };
    schedule(&rules, state, memories, arrival.fresh, &mut events);
    let stopped =
        state.mode == Mode::SafeStop && arm.brakes(state, memories, arrival.fresh && at_rest());
    Report {
        mode: state.mode,
        fault: state.fault,
        refusal: step.refusal,
        events: events | Events::REFUSED.when(step.refusal.is_some()),
        brake: stopped || state.mode == Mode::Idle,
        misses: state.arrivals.misses,
        lost: state.arrivals.lost(),
        error_share: state.error_share,
    }
}

/// Returns true if a joint is outside of the box that its reference is kept in.
fn is_outside<R: Real>(rules: &[JointRules<R>], sample: &Sample<'_, R>) -> bool {
    let joints = rules.iter().zip(sample.joints);
    joints.filter_map(|(rule, m)| Some(!rule.boxed.as_ref()?.contains(m.q))).any(|outside| outside)
}

impl<R: Real> ArmRules<R> {
    /// Returns true if a stop requests the brakes; the request stays for the rest of the stop.
    fn brakes(&self, state: &mut ArmState, memories: &[JointMemory<R>], rests: bool) -> bool {
        let late = state.in_mode >= self.stop_samples_max;
        let blind = state.arrivals.misses > self.hold_samples;
        let driven =
            memories.iter().any(|m| m.stopping.let_go > 0 || m.stopping.faster > self.hold_samples);
        let asks = rests || late || blind || driven || state.trust <= Trust::Held;
        state.braking = match state.braking {
            Some(samples) => Some(samples.saturating_add(1)),
            None => asks.then_some(0),
        };
        state.braking.is_some()
    }

    /// Returns true if the law computes the torque of a fresh sample.
    fn law_runs(&self, state: &ArmState) -> bool {
        match state.mode {
            Mode::Holding | Mode::Tracking => true,
            Mode::SafeStop => {
                let braked = self.brake_samples.zip(state.braking);
                state.trust == Trust::Law && braked.is_none_or(|(takes, samples)| samples < takes)
            }
            Mode::Idle | Mode::Armed => false,
        }
    }
}

/// Returns true after a gap, until the velocities agree with the positions (100 samples at most): such a
/// sample gives the position of the arm, not its motion since the last one.
fn after_a_gap<R: Real>(
    arm: &ArmRules<R>,
    state: &mut ArmState,
    memories: &mut [JointMemory<R>],
    sample: &Sample<'_, R>,
) -> bool {
    let gap = state.gap > 0;
    state.gap = if state.arrivals.misses > 0 {
        GAP_SAMPLES
    } else if gap && state.trust == Trust::Law && !goes_as_it_says(arm, memories, sample) {
        state.gap - 1
    } else {
        0
    };
    if core::mem::replace(&mut state.jumped, state.arrivals.bad > 0) {
        for memory in memories {
            memory.stopping.begun = false;
        }
    }
    gap
}

/// Longest wait for a velocity that agrees with the positions after a gap \[samples\], and the largest
/// difference that counts as agreement \[rad/s\].
const GAP_SAMPLES: u8 = 100;
const GAP_VELOCITY: f64 = 0.5;

/// Returns true if the motion of every joint over the last sample agrees with its velocity.
fn goes_as_it_says<R: Real>(
    arm: &ArmRules<R>,
    memories: &[JointMemory<R>],
    sample: &Sample<'_, R>,
) -> bool {
    let most = R::from_f64(GAP_VELOCITY) * arm.period;
    let mut joints = memories.iter().zip(sample.joints);
    joints.all(|(memory, m)| (m.q - memory.measured.q - m.dq * arm.period).abs() <= most)
}

/// Samples in a row whose positions and velocities agree, after which sensors that could not be believed are
/// believed again; and the speed below which a joint may stand still \[rad/s\].
const SOUND_SAMPLES: u32 = 100;
const STANDING: f64 = 0.02;

/// Sensors that failed and are sound again are better than none: the law goes on with the stop. Where a
/// position jumped, it may stay wrong, and nothing acts from a position.
fn believe_again<R: Real>(
    arm: &ArmRules<R>,
    state: &mut ArmState,
    memories: &mut [JointMemory<R>],
    sample: &Sample<'_, R>,
    fresh: bool,
) {
    if state.trust != Trust::Damper || state.mode != Mode::SafeStop {
        return;
    }
    let moves = |(memory, m): (&JointMemory<R>, &Measurement<R>)| {
        m.dq.abs() <= R::from_f64(STANDING) || (m.q - memory.measured.q).abs() > R::ZERO
    };
    let sound = fresh
        && goes_as_it_says(arm, memories, sample)
        && memories.iter().zip(sample.joints).all(moves);
    state.sound = if sound { state.sound.saturating_add(1) } else { 0 };
    if state.sound >= SOUND_SAMPLES {
        state.trust = state.regains;
        for memory in memories {
            memory.stopping.begun = false;
        }
    }
}

/// Stores `φ̂` of the joints for a later stop, from before its cause. Once the brakes are closed in a stop,
/// the torque that held the arm until then is held.
fn remember_before<R: Real>(
    arm: &ArmRules<R>,
    state: &mut ArmState,
    memories: &mut [JointMemory<R>],
) {
    if state.mode == Mode::SafeStop && state.braking.is_some() && state.braking == arm.brake_samples
    {
        for memory in memories.iter_mut() {
            memory.held = memory.steady;
        }
    }
    state.block = state.block.saturating_add(1);
    if state.block < arm.block || state.mode == Mode::SafeStop {
        return;
    }
    state.block = 0;
    for memory in memories {
        let [now, _] = memory.before_now;
        memory.before_now = [memory.steady, now];
    }
}

/// Every joint enters the mode that is now in force.
fn act<R: Real>(
    rules: &Rules<'_, R>,
    memories: &mut [JointMemory<R>],
    (sample, request): (&Sample<'_, R>, &Request<'_, R>),
    (fresh, learnt): (bool, bool),
    action: Action,
) {
    for (joint, (rule, memory)) in rules.joints.iter().zip(memories).enumerate() {
        let m = measured(memory, sample, joint, fresh);
        let preset = request.preset.and_then(|p| p.get(joint)).copied();
        let preset = preset.filter(|p| R::doubt([*p]) == R::ZERO);
        rule.act(memory, &m, action, (preset, learnt), rules.arm.blend);
    }
}

/// The joint's sample, or the last one believed.
fn measured<R: Real>(
    memory: &JointMemory<R>,
    sample: &Sample<'_, R>,
    joint: usize,
    fresh: bool,
) -> Measurement<R> {
    let new = if fresh { sample.joints.get(joint) } else { None };
    *new.unwrap_or(&memory.measured)
}

/// Blocks of a quarter of a second that a stop has lasted before `φ̂` is taken for gravity, not for the push that
/// caused it.
const ALONE_BLOCKS: u32 = 4;

/// State of the arm at this sample that the laws of all joints use.
fn moment<R: Real>(
    arm: &ArmRules<R>,
    state: &ArmState,
    arrival: &SampleArrival,
    action: Action,
) -> ArmMoment<R> {
    // The law starts at this sample: what happened before it is not its own.
    let elapsed = if action == Action::Engage { None } else { arrival.elapsed_ns };
    let stopping = state.mode == Mode::SafeStop;
    // A stop goes on by a clock that is wrong.
    let elapsed = if stopping { elapsed.or(Some(arm.arrivals.period_ns)) } else { elapsed };
    ArmMoment {
        interval: interval(elapsed, arm.arrivals.period_ns, arm.nominal()),
        reference_progress: R::from_f64(f64::from(state.blending)) * arm.blend_rate,
        blend: arm.blend,
        blend_rate: arm.blend_rate,
        aim: match state.mode {
            Mode::SafeStop => Aim::Stop,
            Mode::Tracking => Aim::Track,
            Mode::Idle | Mode::Armed | Mode::Holding => Aim::Hold,
        },
        alone: stopping && state.in_mode >= ALONE_BLOCKS * arm.block,
        feeds: state.feeds && !stopping,
        first_motion: (ENGAGED_SAMPLES..arm.first_motion_samples).contains(&state.engaged),
        saturation: arm.saturation_samples,
        average: arm.average,
        dwell: arm.dwell_samples,
    }
}

/// Samples after the law took over in which another torque may still act: that of who held the arm before.
const ENGAGED_SAMPLES: u32 = 10;

/// Every joint's torque where the law runs on a fresh sample.
fn run<R: Real>(
    rules: &[JointRules<R>],
    memories: Memories<'_, R>,
    now: &ArmMoment<R>,
    sample: &Sample<'_, R>,
    commands: &mut [Command<R>],
) -> Events {
    let mut events = Events::NONE;
    let raised = memories.arm.raised;
    let joints =
        rules.iter().zip(memories.joints).zip(sample.joints.iter().zip(commands)).enumerate();
    for (joint, ((rule, memory), (m, command))) in joints {
        let gains = rule.in_force(raised);
        let arm = &mut *memories.arm;
        let place = JointInForce { joint, rule, gains };
        let path = match gains.path {
            // A stop is not slowed down.
            Path::Filtered if now.stops() && gains.form == Form::Positions => Path::Positions,
            Path::Literal | Path::Filtered if now.stops() => Path::Observer,
            path => path,
        };
        events |= match path {
            Path::Observer => place.follow::<AsObserver>(arm, memory, m, now, command),
            Path::Literal => place.follow_apart::<AsLiteral>(arm, memory, m, now, command),
            Path::Positions => place.follow_apart::<FromPositions>(arm, memory, m, now, command),
            Path::Filtered => place.follow_filtered(arm, memory, m, now, command),
        };
    }
    events
}

/// One joint of the arm, and the gains in force.
struct JointInForce<'a, R> {
    joint: usize,
    rule: &'a JointRules<R>,
    gains: &'a JointGains<R>,
}

impl<R: Real> JointInForce<'_, R> {
    /// Writes the joint's torque and returns the events of its sample.
    #[allow(clippy::inline_always, reason = "a call each would cost a hundred instructions")]
    #[inline(always)]
    fn follow<S: Built>(
        &self,
        arm: &mut ArmState,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        now: &ArmMoment<R>,
        command: &mut Command<R>,
    ) -> Events {
        let (answer, news) = self.rule.follow::<S>(self.gains, memory, m, now);
        memory.measured = *m;
        *command = answer;
        note(arm, self.joint, &answer, news)
    }

    /// As [`Self::follow`], out of the way of the law that most run.
    #[cold]
    #[inline(never)]
    fn follow_apart<S: Built>(
        &self,
        arm: &mut ArmState,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        now: &ArmMoment<R>,
        command: &mut Command<R>,
    ) -> Events {
        self.follow::<S>(arm, memory, m, now, command)
    }

    /// With a low-pass on the torque command, out of the way of the laws without one.
    #[cold]
    #[inline(never)]
    fn follow_filtered(
        &self,
        arm: &mut ArmState,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        now: &ArmMoment<R>,
        command: &mut Command<R>,
    ) -> Events {
        match self.gains.form {
            Form::Observer => self.follow::<Filtered<AsObserver>>(arm, memory, m, now, command),
            Form::Literal => self.follow::<Filtered<AsLiteral>>(arm, memory, m, now, command),
            Form::Positions => self.follow::<Filtered<FromPositions>>(arm, memory, m, now, command),
        }
    }
}

/// Every joint's torque where the law does not run, or has no fresh sample.
fn rest<R: Real>(
    rules: &Rules<'_, R>,
    memories: Memories<'_, R>,
    sample: &Sample<'_, R>,
    (fresh, known): (bool, bool),
    commands: &mut [Command<R>],
) -> Events {
    let mut events = Events::NONE;
    let state = memories.arm;
    let stop = rules.arm.stop(state, known);
    let long = state.arrivals.misses > rules.arm.hold_samples;
    let joints = rules.joints.iter().zip(memories.joints).zip(commands).enumerate();
    for (joint, ((rule, memory), command)) in joints {
        let m = measured(memory, sample, joint, fresh);
        let (answer, news) = match state.mode {
            Mode::Holding | Mode::Tracking => rule.wait(memory, long),
            Mode::SafeStop if !known => rule.stop_blind(memory, &stop),
            Mode::Armed | Mode::SafeStop => rule.rest(memory, &m, &stop),
            Mode::Idle => rule.free(memory, &m),
        };
        memory.measured = m;
        *command = answer;
        events |= note(state, joint, &answer, news);
    }
    events
}

/// Keeps the counters of a mode.
fn enter(state: &mut ArmState, mode: Mode, action: Action) {
    state.in_mode = if action == Action::None { state.in_mode.saturating_add(1) } else { 0 };
    state.engaged = state.engaged.saturating_add(1);
    state.blending = state.blending.saturating_add(1);
    match action {
        Action::Capture => {
            state.fault = None;
            state.trust = Trust::Law;
            (state.regains, state.sound) = (Trust::Law, 0);
        }
        Action::Engage => {
            state.engaged = 0;
            state.raised = false;
            state.settled = 0;
            state.disturbed = 0;
        }
        Action::Follow | Action::Settle => state.blending = 0,
        Action::Stop => state.braking = None,
        Action::None | Action::Release => {}
    }
    state.mode = mode;
}

/// Events of a joint's sample; a fault that the law detected stops the arm at the next sample.
fn note<R: Real>(
    state: &mut ArmState,
    joint: usize,
    command: &Command<R>,
    news: JointNews,
) -> Events {
    if let Some(fault) = news.fault {
        state.pending = state.pending.or(Some((fault, joint)));
    }
    if news.share > state.error_share {
        state.error_share = news.share;
    }
    news.events
        | Events::SATURATED.when(command.status.saturated)
        | Events::RATE_LIMITED.when(command.status.rate_limited)
}
