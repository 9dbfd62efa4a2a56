//! Scope of a class bound: class, arm with each payload, friction, encoder, feed-forward, read from a study once.

use phihat::Form;
use phihat_certificate::extremes::larger;
use phihat_certificate::{ClassSignals, FrozenPayload, Gains, JointRecord, LoopModel};
use phihat_model::{Body, Model, Rotor, Workspace};
use phihat_study::{Held, Known, MotionClass, ReferenceRequest, Study, SupervisorRequest};

use super::imperfect::{LossSpan, imperfections, loosening, offset, refused_signals, signals};
use super::refusal::ClassRefusal;
use super::slopes::Posed;
use crate::tube::{TubeRefusal, modelled};

/// Longest time between the moment from which nothing holds an arm but the torque that its supervisor is armed with,
/// and the first sample of the law \[samples\].
pub(super) const BEFORE: u32 = 4;

/// The arm with one payload.
#[derive(Debug, Clone)]
pub(super) struct PayloadCase {
    pub(super) payload: Option<FrozenPayload>,
    pub(super) model: Model,
}

/// Torque that is fed forward in place of `M̄ q̈_d`, or on top of it.
#[derive(Debug, Clone)]
pub(super) struct FedForward {
    pub(super) model: Model,
    /// True if only the torque that holds the arm is fed forward.
    pub(super) gravity_alone: bool,
}

/// Everything that does not depend on a posture.
#[derive(Debug)]
pub(super) struct ClassScene<'a> {
    pub(super) n: usize,
    pub(super) period: f64,
    pub(super) class: &'a MotionClass,
    pub(super) records: &'a [JointRecord],
    pub(super) models: Vec<LoopModel>,
    pub(super) cases: Vec<PayloadCase>,
    /// `M̄` \[kg·m²\] per joint.
    pub(super) nominal: Vec<f64>,
    /// Level of forces that may do anything in time \[N·m\]: dry friction or breakaway level, pushes, dry friction fed
    /// forward.
    pub(super) dry: Vec<f64>,
    /// Part of it that stiction is beyond dry friction \[N·m\].
    pub(super) sticks: Vec<f64>,
    /// Largest slope of smooth friction \[N·m·s/rad\].
    pub(super) slope: Vec<f64>,
    /// Largest error of a reading \[rad\], and the part of it that is noise.
    pub(super) reading: Vec<f64>,
    pub(super) noise: Vec<f64>,
    pub(super) fed: Option<FedForward>,
    /// The arm whose torque of gravity the robot adds at each sample.
    pub(super) added: Option<Model>,
    /// Torque by which a start may be out of balance \[N·m\] per joint.
    pub(super) start: Vec<f64>,
    /// Time for which it may be so before the law begins, as (CM7) counts it \[s\].
    pub(super) before: f64,
    /// Largest age of the acceleration that is fed forward, against the middle of the time in which it acts, in
    /// samples.
    pub(super) late: f64,
    /// Stiction, jitter, lost commands; and their rows in samples.
    pub(super) signals: ClassSignals,
    pub(super) rows: Option<LossSpan>,
    /// Samples from a command to its torque.
    pub(super) delay: usize,
}

impl<'a> ClassScene<'a> {
    /// Reads a study.
    pub(super) fn new(study: &'a Study, gains: &'a Gains) -> Result<Self, ClassRefusal> {
        let ReferenceRequest::Any { class, .. } = &study.reference else {
            return Err(ClassRefusal::NoClass);
        };
        let n = study.robot.joints.len();
        if gains.joints.len() != n {
            return Err(ClassRefusal::Gains(format!("gains of {} joints", gains.joints.len())));
        }
        let models: Vec<LoopModel> =
            (0..n).map(|i| LoopModel::from_study(study, i).with_choices_of(gains, study)).collect();
        covered(study, &models)?;
        let signals = signals(study);
        let sticks = |i: usize| larger(0.0, signals.stiction_nm[i] - study.design.coulomb.1[i]);
        let sticks: Vec<f64> = (0..n).map(sticks).collect();
        let mut dry: Vec<f64> = (0..n).map(|i| loosening(study, &signals, i)).collect();
        for push in &study.world.pushes {
            dry[push.joint] += push.torque.abs();
        }
        let fed = fed_forward(study, &mut dry)?;
        let bits = study.sensor.encoder_bits.as_deref();
        let quantum =
            |i: usize| bits.map_or(0.0, |bits| crate::sampled::TorqueNoise::quantum(bits[i]));
        let reading = |i: usize| 0.5 * quantum(i) + offset(study, i);
        let period = study.control.period_ns as f64 * 1e-9;
        let cases = cases(study)?;
        let bare = || study.robot.plant_model().with_gravity(study.world.gravity);
        let added = study.interface.profile.adds_gravity.then(bare);
        let delay = models.iter().map(|model| model.delay_samples).max().unwrap_or(0);
        let (start, before, late) = match &study.supervisor {
            Some(supervisor) => (
                out_of_balance((study, class), supervisor, (&cases, added.as_ref())),
                f64::from(BEFORE) * period,
                f64::from(delay) + 1.0,
            ),
            None => (vec![0.0; n], 0.0, 0.5),
        };
        Ok(Self {
            n,
            period,
            added,
            start,
            before,
            late,
            class,
            records: &gains.joints,
            cases,
            nominal: gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect(),
            slope: (0..n).map(|i| steepest(study, i)).collect(),
            reading: (0..n).map(reading).collect(),
            noise: study.sensor.position_noise_max.clone(),
            models,
            dry,
            sticks,
            fed,
            rows: LossSpan::of(study)?,
            delay: delay as usize,
            signals,
        })
    }

    /// Laws with their loops.
    pub(super) fn loops(&self) -> Vec<(&JointRecord, &LoopModel)> {
        self.records.iter().zip(&self.models).collect()
    }

    /// Torque without friction that motion asks for beyond what is fed forward, `M̄ q̈_d` among that \[N·m\].
    pub(super) fn unknown(
        &self,
        case: &PayloadCase,
        room: &mut Room,
        (q, dq, ddq): (&[f64], &[f64], &[f64]),
        tau: &mut [f64],
    ) {
        self.commanded(case, room, (q, dq, ddq), tau);
        let Some(fed) = &self.fed else {
            for ((tau, m), ddq) in tau.iter_mut().zip(&self.nominal).zip(ddq) {
                *tau -= m * ddq;
            }
            return;
        };
        if fed.gravity_alone {
            room.rest.fill(0.0);
            fed.model.bias(&mut room.fed, q, &room.rest, &mut room.torque);
            for ((torque, m), ddq) in room.torque.iter_mut().zip(&self.nominal).zip(ddq) {
                *torque += m * ddq;
            }
        } else {
            fed.model.inverse_dynamics(&mut room.fed, q, dq, ddq, &mut room.torque);
        }
        for (tau, fed) in tau.iter_mut().zip(&room.torque) {
            *tau -= fed;
        }
    }

    /// Torque of a motion without friction, less what the robot adds by itself \[N·m\].
    pub(super) fn commanded(
        &self,
        case: &PayloadCase,
        room: &mut Room,
        (q, dq, ddq): (&[f64], &[f64], &[f64]),
        tau: &mut [f64],
    ) {
        case.model.inverse_dynamics(&mut room.arm, q, dq, ddq, tau);
        if let Some(bare) = &self.added {
            room.rest.fill(0.0);
            bare.bias(&mut room.added, q, &room.rest, &mut room.torque);
            for (tau, added) in tau.iter_mut().zip(&room.torque) {
                *tau -= added;
            }
        }
    }

    /// The arm with a payload, for its matrices.
    pub(super) fn posed<'b>(&'b self, case: &'b PayloadCase) -> Posed<'b> {
        Posed::of(&case.model, self.added.as_ref(), self.n)
    }

    /// Scratch memory of the arm with a payload.
    pub(super) fn room(&self, case: &PayloadCase) -> Room {
        let fed = self.fed.as_ref().map_or(&case.model, |fed| &fed.model);
        Room {
            added: Workspace::new(self.added.as_ref().unwrap_or(&case.model)),
            arm: Workspace::new(&case.model),
            fed: Workspace::new(fed),
            rest: vec![0.0; self.n],
            torque: vec![0.0; self.n],
        }
    }
}

/// Scratch memory.
#[derive(Debug)]
pub(super) struct Room {
    pub(super) arm: Workspace<f64>,
    fed: Workspace<f64>,
    added: Workspace<f64>,
    rest: Vec<f64>,
    torque: Vec<f64>,
}

/// Largest slope of a joint's smooth friction \[N·m·s/rad\].
fn steepest(study: &Study, i: usize) -> f64 {
    let own = study.robot.joints[i].friction;
    let acts = if study.world.robot_friction { own } else { phihat_model::Friction::default() };
    let bend = acts.sigmoid.map_or(0.0, |s| 0.25 * (s.amplitude_nm * s.steepness_s_rad).abs());
    acts.viscous.abs() + study.world.extra_viscous[i].abs() + bend
}

/// Refuses studies that docs/theory/class.md does not cover.
fn covered(study: &Study, models: &[LoopModel]) -> Result<(), ClassRefusal> {
    let unsupported = |key: &str| ClassRefusal::Unsupported(key.to_owned());
    if let Some(why) = refused_signals(study) {
        return Err(unsupported(why));
    }
    let mut alone = imperfections(study);
    alone.supervisor = None;
    modelled(&alone).map_err(|why| match why {
        TubeRefusal::Unsupported(key) => unsupported(&format!("`{key}`")),
        other => unsupported(&other.to_string()),
    })?;
    let profile = &study.interface.profile;
    let (supervised, feeds) = (study.supervisor.is_some(), study.feedforward.is_some());
    let starts = study.interface.kept && profile.first_torque_max.is_some();
    let balanced = study.world.held == Some(Held::InBalance);
    let refused = [
        (models.iter().any(|m| m.form != Form::Positions), "a form other than \"positions\""),
        (models.iter().any(|m| m.drive_bandwidth_hz.is_some()), "world.drive_bandwidth_hz"),
        (models.iter().any(|m| m.torque_filter_hz.is_some()), "loop.torque_filter_hz"),
        (models.iter().any(|m| m.sample_delay_samples > 0), "sensor.delay_samples"),
        (profile.adds_friction > 0.0, "a robot that compensates friction (profile.adds_friction)"),
        (profile.adds_gravity && feeds, "[feedforward] with a robot that adds gravity"),
        (study.world.start.is_some(), "a start away from the reference"),
        (!supervised && !study.control.preview, "loop.preview = false"),
        (!supervised && starts, "the robot's start rule without a [supervisor]"),
        (!supervised && !balanced, "start.torque_nm other than \"balance\""),
    ];
    refused.iter().find(|(is, _)| *is).map_or(Ok(()), |(_, key)| Err(unsupported(key)))?;
    let changes = study.supervisor.as_deref().and_then(|own| changes_the_law(study, own));
    changes.map_or(Ok(()), |why| Err(unsupported(&why)))
}

/// Option of a supervisor that changes what the law does while nothing is wrong: its key, and the reason.
fn changes_the_law(study: &Study, own: &SupervisorRequest) -> Option<String> {
    let period = study.control.period_ns as f64 * 1e-9;
    let beyond = |(i, preset): (usize, &f64)| {
        study.limits(i).1.is_some_and(|rate| preset.abs() > rate * period)
    };
    let preset = own.preset.iter().flatten().enumerate().any(beyond);
    let listed = [
        (
            study.feedforward.is_some(),
            "feedforward",
            "it is fed along a reference of the sample before",
        ),
        (
            own.dead_zone.is_some(),
            "supervisor.dead_zone_rad",
            "the estimate does not integrate in it",
        ),
        (
            own.funnel.is_some(),
            "supervisor.funnel_initial_rad",
            "another law acts until it is left",
        ),
        (own.soft_zone.is_some(), "supervisor.soft_zone_rad", "it limits torque and estimate"),
        (own.start_first_order, "supervisor.start_first_order", "the first gains are others"),
        (
            own.start_factor.is_some(),
            "supervisor.start_estimator_factor",
            "the first gains are others",
        ),
        (preset, "supervisor.preset_nm", "it takes more than a sample by the torque-rate limit"),
    ];
    let (_, key, why) = listed.into_iter().find(|(is, ..)| *is)?;
    Some(format!("`{key}` ({why})"))
}

/// Torque by which a start may be out of balance \[N·m\] per joint: as stated, else dry friction, in which an arm rests
/// with any torque, or what the torque at the start leaves of gravity anywhere in the box, whichever is larger.
fn out_of_balance(
    (study, class): (&Study, &MotionClass),
    supervisor: &SupervisorRequest,
    (cases, added): (&[PayloadCase], Option<&Model>),
) -> Vec<f64> {
    if let Some(stated) = &supervisor.start_imbalance {
        return stated.clone();
    }
    let n = class.center.len();
    let ends: Vec<(f64, f64)> = class.low.iter().copied().zip(class.high.iter().copied()).collect();
    let preset = |i: usize| supervisor.preset.as_ref().map_or(0.0, |preset| preset[i]);
    let mut most = vec![0.0_f64; n];
    let mut torque = vec![0.0; n];
    for case in cases {
        let mut arm = Posed::of(&case.model, added, n);
        for (k, mut q) in phihat_model::evenly(&ends, STARTS).enumerate() {
            if k % 2 == 0 {
                for (q, (low, high)) in q.iter_mut().zip(&ends) {
                    *q = if *q < 0.5 * (low + high) { *low } else { *high };
                }
            }
            arm.gravity(&q, &mut torque);
            for (i, most) in most.iter_mut().enumerate() {
                *most = larger(*most, STARTS_MARGIN * (torque[i] - preset(i)).abs());
            }
        }
    }
    most.iter().zip(&study.design.coulomb.1).map(|(most, dry)| larger(*most, *dry)).collect()
}

/// Postures at which gravity is looked at for a start, per payload, and the factor on the largest.
const STARTS: u32 = 200;
const STARTS_MARGIN: f64 = 1.1;

/// Model of the torque that is fed forward; its dry friction goes to the forces of any course.
fn fed_forward(study: &Study, dry: &mut [f64]) -> Result<Option<FedForward>, ClassRefusal> {
    let Some(own) = &study.feedforward else { return Ok(None) };
    for (dry, fed) in dry.iter_mut().zip(&own.coulomb) {
        *dry += fed.abs();
    }
    if own.known == Known::Nothing {
        return Ok(None);
    }
    let model = study.robot.plant_model().with_gravity(study.world.gravity);
    let model = model.with_masses_times(own.mass_scale);
    let model = model.map_err(|why| ClassRefusal::Unsupported(why.to_string()))?;
    Ok(Some(FedForward { model, gravity_alone: own.known == Known::Gravity }))
}

/// The arm with the lightest payload, the study's own, and the heaviest at the corners of the box of their centres of
/// mass; with rotors at both ends of their intervals.
fn cases(study: &Study) -> Result<Vec<PayloadCase>, ClassRefusal> {
    let set = &study.design.payload;
    let mut bodies = vec![(set.frame.clone(), set.lightest())];
    bodies.extend(set.heaviest().into_iter().map(|body| (set.frame.clone(), body)));
    bodies.extend(study.world.payload.as_ref().map(|own| (own.frame.clone(), own.body())));
    let rotors: &[Rotor] = if study.robot.has_rotor_interval() {
        &[Rotor::Least, Rotor::Most]
    } else {
        &[Rotor::Stated]
    };
    let mut cases: Vec<PayloadCase> = Vec::new();
    for rotor in rotors {
        let bare = study.robot.plant_model_at(*rotor).with_gravity(study.world.gravity);
        let mut before: Vec<Option<FrozenPayload>> = Vec::new();
        for (frame, body) in &bodies {
            let (payload, model) = loaded(&bare, frame, body)?;
            if before.contains(&payload) {
                continue;
            }
            before.push(payload.clone());
            cases.push(PayloadCase { payload, model });
        }
    }
    Ok(cases)
}

fn loaded(
    bare: &Model,
    frame: &str,
    body: &Body,
) -> Result<(Option<FrozenPayload>, Model), ClassRefusal> {
    if body.mass <= 0.0 {
        return Ok((None, bare.clone()));
    }
    let model = bare.clone().with_payload_on(frame, body);
    let model = model.map_err(|why| ClassRefusal::Payload(why.to_string()))?;
    let payload = FrozenPayload {
        frame: frame.to_owned(),
        mass_kg: body.mass,
        com_m: body.com,
        inertia_kg_m2: body.inertia,
    };
    Ok((Some(payload), model))
}
