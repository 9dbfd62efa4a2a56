//! A rival in the simulator's loop, and what it may know of a study's arm.

use std::sync::{Arc, OnceLock};

use phihat_model::{Joint, ModelError};
use phihat_rivals::{All, RivalRefusal, Running, Supply, TaskCurve};
use phihat_sim::{Driver, Moment, Motion as PlannedMotion, SimError};
use phihat_study::{ReferenceRequest, Study};

/// Link masses of the nominal model over the arm's.
pub const NOMINAL_MASSES: f64 = 0.8;

/// A rival that the simulator can drive with.
#[derive(Debug)]
pub struct Adapter {
    rival: Box<dyn Running>,
    /// Position, velocity, torque that acted, torque commanded last.
    measured: [Vec<f64>; 4],
    wanted: [Vec<f64>; 4],
    /// Motion with preview, for a rival that uses it.
    ahead: Option<PlannedMotion>,
    clipped: Vec<bool>,
    broken: Broken,
}

/// When \[s\] and at which joint a rival first gave a torque that is no number.
pub(crate) type Broken = Arc<OnceLock<(f64, usize)>>;

impl Adapter {
    /// Connects a rival for `joints` joints to the simulator. The rival gets the present reference
    /// acceleration in place of that at the time when its torque acts: see [`Adapter::with_preview`].
    pub fn new(rival: Box<dyn Running>, joints: usize) -> Box<Self> {
        Self::watched(rival, joints, Broken::default())
    }

    /// Gives the rival the reference acceleration at the time when its torque acts, after the study's delay.
    ///
    /// # Errors
    ///
    /// [`SimError`]: the arm cannot follow the study's reference.
    pub fn with_preview(self: Box<Self>, study: &Study) -> Result<Box<Self>, SimError> {
        let mut seeing = study.clone();
        seeing.control.preview = true;
        let ahead = Some(PlannedMotion::of(&seeing)?);
        Ok(Box::new(Self { ahead, ..*self }))
    }

    /// An adapter that writes into `broken` when the rival first gives a torque that is no number.
    pub(crate) fn watched(rival: Box<dyn Running>, joints: usize, broken: Broken) -> Box<Self> {
        let zero = || vec![0.0; joints];
        Box::new(Self {
            rival,
            measured: [zero(), zero(), zero(), zero()],
            wanted: [zero(), zero(), zero(), zero()],
            ahead: None,
            clipped: vec![false; joints],
            broken,
        })
    }
}

impl Driver for Adapter {
    fn drive(&mut self, moment: &Moment<'_>, tau: &mut [f64]) {
        for (i, (measured, wanted)) in
            moment.sample.joints.iter().zip(moment.references).enumerate()
        {
            let columns = [measured.q, measured.dq, measured.tau_applied, moment.last[i].tau];
            for (column, value) in self.measured.iter_mut().zip(columns) {
                column[i] = value;
            }
            let acting = self.ahead.as_ref().map_or(wanted.ddq, |m| m.told(i, moment.t)[2]);
            let columns = [wanted.q, wanted.dq, wanted.ddq, acting];
            for (column, value) in self.wanted.iter_mut().zip(columns) {
                column[i] = value;
            }
            let status = moment.last[i].status;
            self.clipped[i] = status.saturated || status.rate_limited;
        }
        let [q, dq, acted, commanded] = &self.measured;
        let [q_d, dq_d, ddq_d, ddq_d_acting] = &self.wanted;
        let (tau_acted, clipped) = (acted, &self.clipped);
        let all = All { q, dq, tau: tau_acted, commanded, clipped, q_d, dq_d, ddq_d, ddq_d_acting };
        self.rival.update(&all, tau);
        if let Some(joint) = tau.iter().position(|tau| !tau.is_finite()) {
            // Only the first counts.
            self.broken.get_or_init(|| (moment.t, joint));
        }
    }
}

/// Data of a study's arm for a rival: `inertia` \[kg·m²\] per joint; the arm's own model under the study's
/// gravity with links `masses` times as heavy and no payload; and viscous friction.
///
/// # Errors
///
/// [`ModelError`] when `masses` is not above 0 and finite.
pub fn supply(study: &Study, inertia: &[f64], masses: f64) -> Result<Supply, ModelError> {
    let robot = &study.robot;
    let model = robot.plant_model().with_gravity(study.world.gravity);
    let viscous = robot.joints.iter().map(|joint| joint.friction.viscous);
    let extra = &study.world.extra_viscous;
    let known = |(i, v): (usize, f64)| extra[i] + if study.world.robot_friction { v } else { 0.0 };
    // What is added to the robot's own dry friction is for the laws to find. A smooth step counts with its mean level.
    let level = |joint: &Joint| {
        joint.friction.coulomb + joint.friction.sigmoid.map_or(0.0, |step| 0.5 * step.amplitude_nm)
    };
    let dry = |joint: &Joint| if study.world.robot_friction { level(joint) } else { 0.0 };
    Ok(Supply {
        inertia: inertia.to_vec(),
        model: model.with_masses_times(masses)?,
        viscous: viscous.enumerate().map(known).collect(),
        dry: robot.joints.iter().map(dry).collect(),
        torque_max: study.control.torque_max.clone(),
        torque_rate_max: study.control.torque_rate_max.clone(),
        delay_samples: study.control.delay_samples,
        task_period: period(&study.reference),
        tip: robot.tip.clone(),
        orbit: ReferenceTurn::of(study).map(|turn| Arc::new(turn) as Arc<dyn TaskCurve>),
        designed: Err(not_designed()),
        designed_positions: Err(not_designed()),
        designed_filters: Err(not_designed()),
    })
}

fn not_designed() -> RivalRefusal {
    RivalRefusal::NotApplicable("no gains were designed for this arm".to_owned())
}

/// One turn of a study's reference, after its start.
#[derive(Debug)]
struct ReferenceTurn {
    motion: PlannedMotion,
    start: f64,
    period: f64,
}

impl ReferenceTurn {
    fn of(study: &Study) -> Option<Self> {
        let period = period(&study.reference)?;
        let start = match &study.reference {
            ReferenceRequest::Sines { fade_in, .. }
            | ReferenceRequest::Cartesian { fade_in, .. } => *fade_in,
            _ => 0.0,
        };
        let duration = start + 2.0 * period;
        let motion = PlannedMotion::new(&study.reference, &study.robot, duration).ok()?;
        Some(Self { motion, start, period })
    }
}

impl TaskCurve for ReferenceTurn {
    fn at(&self, theta: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        // The middle of two turns: away from both ends of the motion.
        let t = self.start + 0.5 * self.period + theta.rem_euclid(self.period);
        for joint in 0..q.len() {
            [q[joint], dq[joint], ddq[joint]] = self.motion.at(joint, t);
        }
    }

    fn period(&self) -> f64 {
        self.period
    }
}

/// Longest common period that is looked for \[s\].
const PERIOD_MAX: f64 = 60.0;

/// The period of a study's reference \[s\], where it has one: that of a Cartesian curve, or the smallest that
/// all its sines share.
fn period(reference: &ReferenceRequest) -> Option<f64> {
    match reference {
        ReferenceRequest::Cartesian { period, .. } => Some(*period),
        ReferenceRequest::Sines { terms, .. } => {
            let frequencies = || terms.iter().flat_map(|term| &term.frequency);
            let slowest = frequencies().copied().fold(f64::INFINITY, f64::min);
            let whole = |turns: f64| (turns - turns.round()).abs() < 1e-9;
            let shared = |t: &f64| frequencies().all(|f| whole(f * t));
            let turns = (1_u32..1000).map(|k| f64::from(k) / slowest);
            turns.take_while(|t| *t <= PERIOD_MAX).find(shared)
        }
        _ => None,
    }
}
