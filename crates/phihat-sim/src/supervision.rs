//! The core's supervisor in the loop, as a study sets it up.

use phihat::{
    ArmRules, ArmState, Command, Funnel, JointGains, JointMemory, JointOptions, JointRange,
    JointRules, Memories, Mode, ModeRequest, MotionLimits, Options, Reference, Report, Request,
    Rules, Schedule, Stamp, supervise,
};
use phihat_study::{RequestedMode, Study, SupervisorRequest, requested};

use crate::error::SimError;
use crate::in_force::InForce;
use crate::motion::Motion;
use crate::sample::Sample;

/// A supervised arm and what is asked of it over time.
#[derive(Debug)]
pub(crate) struct Supervised {
    rules: (ArmRules<f64>, Vec<JointRules<f64>>),
    state: (ArmState, Vec<JointMemory<f64>>),
    requests: Vec<(f64, RequestedMode)>,
    preset: Option<Vec<f64>>,
    period_ns: u64,
    /// Time on the reference's clock \[ns\]: it runs while the arm tracks.
    motion_ns: u64,
    asked: Vec<Reference<f64>>,
    /// Feed-forward along the reference in force.
    fed: Option<InForce>,
    /// True if `asked` was set by [`refer_to`](Self::refer_to), in place of the study's motion.
    given: bool,
    /// True if the requested motion is shaped to the study's limits.
    shapes: bool,
    /// True if a safe stop is requested, whatever the study requests.
    pub(crate) stopping: bool,
    pub(crate) report: Report,
}

impl Supervised {
    pub(crate) fn new(
        study: &Study,
        request: &SupervisorRequest,
        gains: &[JointGains<f64>],
    ) -> Result<Self, SimError> {
        let options = Options {
            hold_samples: request.hold_samples,
            stop_samples: request.stop_samples,
            start_mismatch_max: request.start_mismatch_max,
            blend_s: request.blend,
            saturation_s: Some(request.saturation),
            brake_s: request.brake_closing,
            schedule: Schedule {
                settled: request.settled,
                disturbed: request.disturbed,
                dwell_s: request.dwell,
            },
            ..Options::new(study.control.period_ns)
        };
        let refused = |e: phihat::OptionError| SimError::Supervisor(e.to_string());
        let rule = |(i, gains): (usize, &JointGains<f64>)| {
            let joint = joint(study, request, gains, i)?;
            JointRules::new(i, gains, &joint, &options).map_err(refused)
        };
        let rules: Result<Vec<_>, _> = gains.iter().enumerate().map(rule).collect();
        Ok(Self {
            rules: (ArmRules::new(&options).map_err(refused)?, rules?),
            state: (ArmState::new(), vec![JointMemory::new(); gains.len()]),
            requests: request.requests.clone(),
            preset: request.preset.clone(),
            period_ns: study.control.period_ns,
            motion_ns: 0,
            asked: vec![Reference::default(); gains.len()],
            fed: InForce::of(study, gains.iter().map(JointGains::inertia).collect())?,
            given: false,
            shapes: request.motion.is_some(),
            stopping: false,
            report: Report::default(),
        })
    }

    /// One sample at time `t` \[s\]; leaves the references in force and the commands.
    pub(crate) fn step(
        &mut self,
        t: f64,
        sample: &Sample,
        motion: &Motion,
        (references, commands): (&mut [Reference<f64>], &mut [Command<f64>]),
    ) {
        let at = self.motion_ns as f64 * 1e-9;
        if !self.given {
            for (i, reference) in self.asked.iter_mut().enumerate() {
                let [q, dq, ddq] = motion.told(i, at);
                *reference = Reference { q, dq, ddq };
            }
        }
        let follows = !self.given && self.state.0.mode() == Mode::Tracking;
        let followed = follows.then_some((motion, at));
        let (mode, samples) = (self.wanted(t), self.report.misses.saturating_add(1));
        let request = Request {
            mode,
            references: &self.asked,
            preset: self.preset.as_deref(),
            feed_forward: self.fed.as_mut().map(|fed| fed.torque(followed, samples)),
        };
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the study bounds the run to a day"
        )]
        let now_ns = (t * 1e9).round() as u64;
        let stamp = Stamp { sequence: sample.sequence, t_ns: sample.t_ns };
        let sample = phihat::Sample { stamp, now_ns, joints: &sample.joints };
        let (arm, joints) = &self.rules;
        let (state, memories) = &mut self.state;
        self.report = supervise(
            Rules { arm, joints },
            Memories { arm: state, joints: memories },
            &sample,
            &request,
            commands,
        );
        if let Some(fed) = self.fed.as_mut().filter(|_| self.report.misses == 0) {
            fed.answered(&self.asked, memories);
        }
        for (reference, memory) in references.iter_mut().zip(memories) {
            *reference = *memory.reference();
        }
        if self.report.mode == Mode::Tracking {
            self.motion_ns += self.period_ns;
        }
    }

    /// From here on requests these positions at rest, in place of the study's motion; `false`: the motion is
    /// not shaped, or the positions are not as many as the joints, or not finite.
    pub(crate) fn refer_to(&mut self, q: &[f64]) -> bool {
        let fits = q.len() == self.asked.len() && q.iter().all(|q| q.is_finite());
        if !self.shapes || !fits {
            return false;
        }
        self.given = true;
        for (reference, q) in self.asked.iter_mut().zip(q) {
            *reference = Reference { q: *q, dq: 0.0, ddq: 0.0 };
        }
        true
    }

    /// Mode requested at time `t`: by default to arm, to hold and to track, one sample each.
    fn wanted(&self, t: f64) -> ModeRequest {
        if self.stopping {
            return ModeRequest::Stop;
        }
        if self.requests.is_empty() {
            return match self.state.0.mode() {
                Mode::Idle => ModeRequest::Arm,
                Mode::Armed => ModeRequest::Hold,
                _ => ModeRequest::Track,
            };
        }
        match requested(&self.requests, t) {
            None | Some(RequestedMode::Idle) => ModeRequest::Idle,
            Some(RequestedMode::Arm) => ModeRequest::Arm,
            Some(RequestedMode::Hold) => ModeRequest::Hold,
            Some(RequestedMode::Track) => ModeRequest::Track,
            Some(RequestedMode::Stop) => ModeRequest::Stop,
        }
    }
}

/// Share of the torque limit by which a torque has to vary for a joint to be judged at first motion, where
/// the study states none.
const FIRST_MOTION_SHARE: f64 = 0.05;

/// The error that stops a joint where the study states none \[rad\].
fn error_stop(study: &Study, joint: usize) -> f64 {
    let bound = study.spec.error_bound.as_ref().and_then(|bounds| bounds.get(joint));
    bound.map_or(0.2, |bound| (50.0 * bound).max(0.2))
}

/// Highest dry friction that the robot's description states \[N·m\]: within it a joint that stands still is
/// no dead drive.
fn dry_friction(study: &Study, joint: usize) -> f64 {
    let friction = &study.robot.joints[joint].friction;
    let coulomb = friction.coulomb_range.map_or(friction.coulomb, |(_, most)| most);
    coulomb + friction.sigmoid.map_or(0.0, |smooth| smooth.amplitude_nm.abs())
}

/// The options of one joint.
fn joint(
    study: &Study,
    request: &SupervisorRequest,
    gains: &JointGains<f64>,
    i: usize,
) -> Result<JointOptions<f64>, SimError> {
    let per = |values: &Option<Vec<f64>>| values.as_ref().map(|v| v[i]);
    let range = per(&request.soft_zone).zip(study.robot.joints[i].position);
    Ok(JointOptions {
        velocity_max: per(&request.velocity_max),
        range: range.map(|(soft, (lower, upper))| JointRange {
            lower,
            upper,
            soft,
            braking: request.braking,
        }),
        error_stop: per(&request.error_stop).or_else(|| Some(error_stop(study, i))),
        frozen_travel: per(&request.frozen_travel),
        motion: request.motion.as_ref().map(|[velocity, acceleration, jerk]| MotionLimits {
            velocity: velocity[i],
            acceleration: acceleration[i],
            jerk: jerk[i],
        }),
        reference_box: request.reference_box.as_ref().map(|[low, high]| (low[i], high[i])),
        error_bound: per(&request.error_bound).filter(|_| request.error_bound_stop),
        dead_zone: per(&request.dead_zone),
        funnel: request.funnel.as_ref().map(|[initial, last]| Funnel {
            initial: initial[i],
            r#final: last[i],
            decay_s: request.funnel_decay,
        }),
        oscillation: per(&request.oscillation),
        first_motion: per(&request.first_motion).or_else(|| {
            let torque = study.limits(i).0?;
            Some((FIRST_MOTION_SHARE * torque).max(1.5 * dry_friction(study, i)))
        }),
        stop: None,
        start: start(request, gains)?,
    })
}

/// The gains it starts with, where they are others.
fn start(
    request: &SupervisorRequest,
    gains: &JointGains<f64>,
) -> Result<Option<JointGains<f64>>, SimError> {
    let first = request.start_first_order.then(|| gains.first_order());
    let Some(factor) = request.start_factor else { return Ok(first) };
    let refused = || {
        let why = "start_estimator_factor: these gains have no estimator that could be slower";
        SimError::Supervisor(why.to_owned())
    };
    first.unwrap_or(*gains).slower(factor).ok_or_else(refused).map(Some)
}
