//! Scope of a tube: arm, friction, payload, loop and motion, read from a study once.

use phihat_certificate::extremes::Extremes as _;
use phihat_model::{Body, Model, Sigmoid};
use phihat_study::{PayloadSet, Push, Study};

use super::controller::SampledLaw;
use super::desired::Desired;
use super::refusal::TubeRefusal;
use crate::certificate::missing;
use crate::sampled::{LoopModel, TorqueNoise};
use phihat_certificate::{Gains, NotCounted};

/// Velocity at which the simulator's Coulomb law reaches 1/√2 of its level \[rad/s\].
pub(super) const COULOMB_VELOCITY: f64 = 1e-3;

/// Share of a step within which an edge of a push is at its end.
const ALIGNED: f64 = 1e-6;

/// Smooth friction of one joint, and its interval of dry friction.
#[derive(Debug, Clone, Copy)]
pub(super) struct SceneFriction {
    pub(super) viscous: f64,
    pub(super) sigmoid: Option<Sigmoid>,
    /// Least and largest Coulomb level \[N·m\].
    pub(super) level: (f64, f64),
    /// Friction that the robot compensates by itself: share times its own friction.
    pub(super) added: Option<AddedFriction>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct AddedFriction {
    pub(super) share: f64,
    pub(super) own: phihat_model::Friction,
}

/// `v/√(v² + v_c²)`.
pub(super) fn dry(v: f64) -> f64 {
    let share = v / COULOMB_VELOCITY;
    share / (1.0 + share * share).sqrt()
}

impl SceneFriction {
    pub(super) fn smooth(&self, v: f64) -> f64 {
        self.viscous * v + self.sigmoid.map_or(0.0, |law| law.torque(v))
    }

    pub(super) fn slope(&self, v: f64) -> f64 {
        self.viscous + self.sigmoid.map_or(0.0, |law| slope(&law, v))
    }

    /// Largest `|F''|` between two velocities.
    pub(super) fn bend(&self, (low, high): (f64, f64)) -> f64 {
        let of = |law: &Sigmoid, share: f64| share * bend(law, (low, high));
        let own = self.sigmoid.map_or(0.0, |law| of(&law, 1.0));
        own + self.added.map_or(0.0, |a| a.own.sigmoid.map_or(0.0, |law| of(&law, a.share)))
    }
}

impl AddedFriction {
    /// Without its Coulomb part.
    pub(super) fn smooth(&self, v: f64) -> f64 {
        self.share * (self.own.viscous * v + self.own.sigmoid.map_or(0.0, |law| law.torque(v)))
    }

    pub(super) fn slope(&self, v: f64) -> f64 {
        self.share * (self.own.viscous + self.own.sigmoid.map_or(0.0, |law| slope(&law, v)))
    }

    pub(super) fn level(&self) -> f64 {
        self.share * self.own.coulomb
    }
}

fn logistic(law: &Sigmoid, v: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-law.steepness_s_rad * (v + law.offset_rad_s)))
}

fn slope(law: &Sigmoid, v: f64) -> f64 {
    let z = logistic(law, v);
    law.amplitude_nm * law.steepness_s_rad * z * (1.0 - z)
}

/// Largest `|σ''|` over an interval: `A s² |z(1 − z)(1 − 2z)|` peaks at `z = ½ ± 1/√12`.
fn bend(law: &Sigmoid, (low, high): (f64, f64)) -> f64 {
    let at = |z: f64| (z * (1.0 - z) * (1.0 - 2.0 * z)).abs();
    let (a, b) = (logistic(law, low), logistic(law, high));
    let (a, b) = (a.min(b), a.max(b));
    let half = 1.0 / 12.0_f64.sqrt();
    let mut most = at(a).max(at(b));
    for peak in [0.5 - half, 0.5 + half] {
        if a <= peak && peak <= b {
            most = most.max(at(peak));
        }
    }
    (law.amplitude_nm * law.steepness_s_rad * law.steepness_s_rad).abs() * most
}

/// Everything that does not change along the run.
#[derive(Debug)]
pub(super) struct Scene<'a> {
    pub(super) n: usize,
    pub(super) period: f64,
    pub(super) samples: usize,
    pub(super) substeps: u32,
    pub(super) names: Vec<String>,
    pub(super) law: SampledLaw,
    pub(super) friction: Vec<SceneFriction>,
    pub(super) pushes: &'a [Push],
    /// Edges of pushes between steps.
    pub(super) edges: Vec<Edge>,
    pub(super) start: (Vec<f64>, Vec<f64>),
    /// Torque that held the arm before the first sample.
    pub(super) held: Vec<f64>,
    pub(super) measured_velocity: bool,
    /// True if a law subtracts its feed-forward from the torque that acted.
    pub(super) expects: bool,
    /// Torque limit, and largest change per sample.
    pub(super) limits: Vec<(f64, f64)>,
    /// The bare arm under gravity.
    pub(super) bare: Model,
    /// True if the robot adds gravity of the bare arm.
    pub(super) adds_gravity: bool,
    pub(super) payload: Option<PayloadSet>,
    pub(super) desired: &'a Desired,
}

/// Largest error of a reading behind encoders of so many bits \[rad\].
pub(super) fn misread(study: &Study, bits: Option<&[u32]>) -> Vec<f64> {
    let quantum = |i: usize| bits.map_or(0.0, |bits| TorqueNoise::quantum(bits[i]));
    let biases = study.sensor.position_bias.iter().enumerate();
    biases.map(|(i, bias)| 0.5 * quantum(i) + bias.abs()).collect()
}

impl<'a> Scene<'a> {
    #[allow(clippy::too_many_lines, reason = "one line per part of a study")]
    pub(super) fn new(
        study: &'a Study,
        gains: &Gains,
        desired: &'a Desired,
    ) -> Result<Self, TubeRefusal> {
        let n = study.robot.joints.len();
        let (low, high) = &study.design.coulomb;
        let period = study.control.period_ns as f64 * 1e-9;
        let profile = &study.interface.profile;
        modelled(study)?;
        let models: Vec<LoopModel> =
            (0..n).map(|i| LoopModel::from_study(study, i).with_choices_of(gains, study)).collect();
        let starts_at_zero = study.interface.kept && profile.first_torque_max.is_some();
        let law = SampledLaw::new(gains, &models, (starts_at_zero, study.world.held.is_some()));
        let friction = |i: usize| {
            let own = study.robot.joints[i].friction;
            let acts =
                if study.world.robot_friction { own } else { phihat_model::Friction::default() };
            SceneFriction {
                viscous: acts.viscous + study.world.extra_viscous[i],
                sigmoid: acts.sigmoid,
                level: (low[i], high[i]),
                added: (profile.adds_friction > 0.0)
                    .then_some(AddedFriction { share: profile.adds_friction, own }),
            }
        };
        let limit = |i: usize| {
            let (torque, rate) = study.limits(i);
            let rule = profile.torque_rate_max;
            let rate = rate.into_iter().chain(rule).least();
            let clamp = study.robot.joints[i].torque_max.filter(|_| profile.clamps_torque);
            let torque = torque.into_iter().chain(clamp).least();
            (torque, rate * period)
        };
        let start = match &study.world.start {
            Some(start) => (start.q.clone(), start.dq.clone()),
            None => (desired.q[..n].to_vec(), desired.dq[..n].to_vec()),
        };
        let samples = desired.q.len() / n;
        if samples < 2 || desired.q.len() != samples * n {
            return Err(TubeRefusal::Unsupported("duration_s of a sample".to_owned()));
        }
        Ok(Self {
            n,
            period,
            samples,
            substeps: study.world.substeps,
            names: study.robot.joint_names(),
            friction: (0..n).map(friction).collect(),
            pushes: &study.world.pushes,
            edges: edges(study, period),
            held: study.held_torque(&start.0).unwrap_or_else(|| vec![0.0; n]),
            start,
            expects: law.subtracts_feed_forward(),
            measured_velocity: law.measures_velocity(),
            law,
            limits: (0..n).map(limit).collect(),
            bare: study.robot.plant_model().with_gravity(study.world.gravity),
            adds_gravity: profile.adds_gravity,
            payload: Some(&study.design.payload).filter(|set| set.mass.1 > 0.0).cloned(),
            desired,
        })
    }

    /// The arm with a body on the payload's frame, `com` from the middle of the box.
    pub(super) fn loaded(
        &self,
        mass: f64,
        off: [f64; 3],
        inertia: [f64; 6],
    ) -> Result<Model, TubeRefusal> {
        let Some(set) = &self.payload else { return Ok(self.bare.clone()) };
        let middle = centre(set);
        let com = core::array::from_fn(|i| middle[i] + off[i]);
        let body = Body { mass, com, inertia };
        let loaded = self.bare.clone().with_payload_on(&set.frame, &body);
        loaded.map_err(|why| TubeRefusal::Payload(why.to_string()))
    }

    /// Torques of declared pushes at a time, as the simulator has them.
    pub(super) fn push(&self, t: f64, tau: &mut [f64]) {
        tau.fill(0.0);
        for push in self.pushes {
            if push.start <= t && t < push.start + push.duration {
                tau[push.joint] += push.torque;
            }
        }
    }
}

/// An edge of a push that is no step of the study's simulator: one of them acts a part of a step longer than the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edge {
    /// Interval that it lies in.
    pub(super) sample: usize,
    pub(super) joint: usize,
    /// Twice the largest mean of the difference in torque over the interval \[N·m\]: responses to a pulse
    /// within an interval lie between those at its ends, of which a sum holds the mean.
    pub(super) torque: f64,
}

/// Edges of pushes between steps.
fn edges(study: &Study, period: f64) -> Vec<Edge> {
    let steps = f64::from(study.world.substeps);
    let step = period / steps;
    let all = study.world.pushes.iter().flat_map(|push| {
        [push.start, push.start + push.duration].map(|t| (t, push.joint, push.torque))
    });
    all.filter(|(t, ..)| (t / step - (t / step).round()).abs() > ALIGNED)
        .map(|(t, joint, torque)| {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "times of a study are finite and not negative"
            )]
            let sample = (t / period).floor().max(0.0) as usize;
            Edge { sample, joint, torque: 2.0 * torque.abs() / steps }
        })
        .collect()
}

/// Checks that a study has nothing which the linear loop lacks: what forbids the loop model, what is not
/// counted in a tube, and what stands around the law or behind it.
///
/// # Errors
///
/// [`TubeRefusal::Unsupported`] names the key.
pub fn modelled(study: &Study) -> Result<(), TubeRefusal> {
    let forbidden = missing(study).first().map(|(key, _)| (*key).to_owned());
    let left_out = || NotCounted::of(study).into_iter().find(NotCounted::forbids_tube);
    let profile = &study.interface.profile;
    let adds = profile.adds_gravity || profile.adds_friction > 0.0;
    // What the robot adds goes through the drive; here it acts at once.
    let lagged = adds && study.world.drive_bandwidth_hz.is_some();
    let key = forbidden
        .or_else(|| left_out().map(|one| one.key))
        .or_else(|| study.supervisor.is_some().then(|| "supervisor".to_owned()))
        .or_else(|| study.world.drive.is_some().then(|| "world.drive".to_owned()))
        .or_else(|| lagged.then(|| "world.drive_bandwidth_hz with what the robot adds".to_owned()));
    key.map_or(Ok(()), |key| Err(TubeRefusal::Unsupported(key)))
}

/// Middle of the centre of mass's box.
pub(super) fn centre(set: &PayloadSet) -> [f64; 3] {
    set.com.map(|(low, high)| 0.5 * (low + high))
}

/// Half widths of the box.
pub(super) fn half(set: &PayloadSet) -> [f64; 3] {
    set.com.map(|(low, high)| 0.5 * (high - low))
}
