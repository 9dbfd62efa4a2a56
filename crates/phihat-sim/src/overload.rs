//! Before a design or a run: whether the drives have what the motion needs.

use std::fmt;

use phihat_model::{Body, JointKind, Model, Workspace};
use phihat_study::{DrivesBeyond, Study};

use crate::error::SimError;
use crate::motion::Motion;
use crate::world::{SimulatedFriction, frictions, frictions_of_robot, loaded, loaded_model};

/// Instants of a motion that are looked at, at most; a shorter run is looked at sample by sample.
const INSTANTS: u64 = 20_000;

/// Slack for figures that were rounded when they were written down, relative.
const ROUNDING: f64 = 1e-6;

/// Slowest motion that is tried, as a factor on its times, and the digits of what is told: one hundredth.
const SLOWEST: f64 = 100.0;
const DIGIT: f64 = 100.0;

/// Halvings of the factor's logarithm, and hundredths that are tried beyond what was found.
const HALVINGS: u32 = 14;
const STEPS: u32 = 100;

/// Overload of a drive by a motion: the joint whose need is the largest share of its limit.
///
/// # Law
///
/// ```text
/// τ(t) = M(q_d) q̈_d + C(q_d, q̇_d) q̇_d + g(q_d) + τ_f(q̇_d) − (torque that the robot adds by itself)
/// |τ| ≤ limit,  |q̇_d| ≤ limit                                                           (1)
/// ```
///
/// `M` with the rotors and with one payload after the other: that of the world, and the lightest and heaviest
/// point mass of the design, at every corner of the box of its centres of mass. `τ_f` has the highest level
/// of dry friction of the design. The limit is that of the command, [`Study::limits`].
///
/// # Not claimed
///
/// Pushes, the way from a start that is not on the reference, encoder noise and an imperfect drive of
/// `[world.drive]` are not included. Runs of more than 20 000 samples are evaluated at 20 000 instants at
/// most.
#[derive(Debug, Clone, PartialEq)]
pub struct Overload {
    /// The joint.
    pub joint: String,
    /// Kind of the joint, which sets the unit.
    pub kind: JointKind,
    /// Quantity that exceeds its limit.
    pub lack: Lack,
    /// When the most of it is needed \[s\].
    pub t: f64,
    /// Required torque or speed \[N·m, rad/s; N, m/s of a prismatic joint\].
    pub need: f64,
    /// Limit of the drive, in the same unit.
    pub limit: f64,
    /// Mass of the payload with which so much is needed \[kg\]; 0: none.
    pub payload_kg: f64,
    /// Other joints that need more than they have.
    pub others: Vec<String>,
    /// Factor on all times of the motion with which every joint has what it needs, found by trials; `None`:
    /// no slower motion helps.
    pub slower: Option<f64>,
}

/// Quantity that a drive lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lack {
    /// Torque \[N·m\], force \[N\] of a prismatic joint.
    Torque,
    /// Speed \[rad/s, m/s\].
    Speed,
}

impl fmt::Display for Overload {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let slides = self.kind == JointKind::Prismatic;
        let (what, unit) = match (self.lack, slides) {
            (Lack::Torque, false) => ("the drive has", "N·m"),
            (Lack::Torque, true) => ("the drive has", "N"),
            (Lack::Speed, false) => ("its limit is", "rad/s"),
            (Lack::Speed, true) => ("its limit is", "m/s"),
        };
        let Self { joint, t, need, limit, .. } = self;
        write!(f, "the motion needs {need:.3} {unit} of {joint} at t = {t:.3} s, {what} {limit}")?;
        if self.payload_kg > 0.0 && self.lack == Lack::Torque {
            write!(f, " (with a payload of {} kg)", self.payload_kg)?;
        }
        if !self.others.is_empty() {
            write!(f, "; {} too", self.others.join(", "))?;
        }
        match self.slower {
            Some(factor) => write!(
                f,
                "\n  = help: {factor:.2} times slower every joint has what it needs: duration_s and all times of \
                 [reference] times {factor:.2}, its frequencies by it"
            )?,
            None => write!(
                f,
                "\n  = help: no slower motion helps, the postures themselves need so much: a smaller payload, other \
                 postures or stronger drives do"
            )?,
        }
        write!(f, "\n  = help: loop.beyond_drives = \"allow\" takes such a motion on purpose")
    }
}

impl std::error::Error for Overload {}

/// Compares a study's motion with its drives; `None`: the drives suffice, or the study allows more on
/// purpose.
///
/// # Errors
///
/// [`SimError`] when the reference cannot be reached or the payload not attached.
pub fn overload(study: &Study) -> Result<Option<Overload>, SimError> {
    if study.control.beyond_drives == DrivesBeyond::Allow {
        return Ok(None);
    }
    OverloadNeeds::of(study).map(|needs| needs.overload(study))
}

/// A motion, instant by instant, and who moves along it.
struct OverloadNeeds {
    instants: Vec<OverloadInstant>,
    /// Mass of the payload \[kg\] and the arm with it.
    cases: Vec<(f64, Model)>,
    own: Model,
    friction: Vec<SimulatedFriction>,
    /// Friction that the robot adds by itself.
    helped: Vec<SimulatedFriction>,
    adds_gravity: bool,
    /// Torque and speed, per joint.
    limits: Vec<[f64; 2]>,
}

struct OverloadInstant {
    t: f64,
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
}

/// The largest share of a limit.
#[derive(Clone, Copy)]
struct Worst {
    share: f64,
    lack: Lack,
    t: f64,
    need: f64,
    payload_kg: f64,
}

impl OverloadNeeds {
    fn of(study: &Study) -> Result<Self, SimError> {
        let motion = Motion::new(&study.reference, &study.robot, study.duration)?;
        let n = study.robot.joints.len();
        let period = study.control.period_ns as f64 * 1e-9;
        let samples = crate::simulation::samples(study.duration, study.control.period_ns);
        let stride = samples.div_ceil(INSTANTS).max(1);
        let instant = |k: u64| {
            let t = (k * stride) as f64 * period;
            let jets: Vec<_> = (0..n).map(|i| motion.at(i, t)).collect();
            let part = |which: usize| jets.iter().map(|jet| jet[which]).collect();
            OverloadInstant { t, q: part(0), dq: part(1), ddq: part(2) }
        };
        let own = study.robot.plant_model().with_gravity(study.world.gravity);
        let carried = study.world.payload.as_ref().map_or(0.0, |payload| payload.mass);
        let mut cases = vec![(carried, loaded_model(study)?)];
        let set = &study.design.payload;
        if set.mass.0 <= 0.0 && carried > 0.0 {
            cases.push((0.0, own.clone()));
        }
        let mut ends = vec![set.mass.0, set.mass.1];
        ends.dedup();
        for mass in ends.into_iter().filter(|mass| *mass > 0.0) {
            for com in set.corners() {
                let body = Body { mass, com, inertia: [0.0; 6] };
                cases.push((mass, loaded(own.clone(), &set.frame, &body)?));
            }
        }
        let profile = &study.interface.profile;
        let mut friction = frictions(study);
        for (friction, most) in friction.iter_mut().zip(&study.design.coulomb.1) {
            friction.coulomb = friction.coulomb.max(*most);
        }
        let helped = frictions_of_robot(study).into_iter().map(|f| f.times(profile.adds_friction));
        let limits = study.robot.joints.iter().enumerate().map(|(i, joint)| {
            [study.limits(i).0, joint.velocity_max].map(|most| most.unwrap_or(f64::INFINITY))
        });
        Ok(Self {
            instants: (0..samples.div_ceil(stride)).map(instant).collect(),
            cases,
            own,
            friction,
            helped: helped.collect(),
            adds_gravity: profile.adds_gravity,
            limits: limits.collect(),
        })
    }

    fn overload(&self, study: &Study) -> Option<Overload> {
        let worst = self.worst(1.0);
        let beyond = |worst: &Worst| worst.share > 1.0 + ROUNDING;
        let joints = || worst.iter().enumerate();
        let (joint, most) = joints().max_by(|a, b| a.1.share.total_cmp(&b.1.share))?;
        if !beyond(most) {
            return None;
        }
        let named = |i: usize| study.robot.joints[i].name.clone();
        let others = joints().filter(|(i, worst)| *i != joint && beyond(worst));
        Some(Overload {
            joint: named(joint),
            kind: study.robot.joints[joint].kind,
            lack: most.lack,
            t: most.t,
            need: most.need,
            limit: self.limits[joint][usize::from(most.lack == Lack::Speed)],
            payload_kg: most.payload_kg,
            others: others.map(|(i, _)| named(i)).collect(),
            slower: self.slower(),
        })
    }

    /// The least factor on all times that was found with which every joint has what it needs, in hundredths.
    fn slower(&self) -> Option<f64> {
        let borne = |factor: f64| self.worst(factor).iter().all(|worst| worst.share <= 1.0);
        if !borne(SLOWEST) {
            return None;
        }
        let (mut low, mut high) = (1.0_f64, SLOWEST);
        for _ in 0..HALVINGS {
            let middle = (low * high).sqrt();
            if borne(middle) { high = middle } else { low = middle }
        }
        // Needs need not fall with every step of it.
        (0..STEPS)
            .map(|step| ((high * DIGIT).ceil() + f64::from(step)) / DIGIT)
            .find(|told| borne(*told))
    }

    /// The largest share of a limit per joint, all times of the motion times a factor.
    fn worst(&self, factor: f64) -> Vec<Worst> {
        let n = self.limits.len();
        let none = Worst { share: 0.0, lack: Lack::Speed, t: 0.0, need: 0.0, payload_kg: 0.0 };
        let mut worst = vec![none; n];
        let zero = vec![0.0; n];
        let (mut tau, mut gravity) = (zero.clone(), zero.clone());
        let mut own = Workspace::new(&self.own);
        let mut arms: Vec<_> =
            self.cases.iter().map(|(mass, model)| (*mass, model, Workspace::new(model))).collect();
        for at in &self.instants {
            let t = at.t * factor;
            let dq: Vec<f64> = at.dq.iter().map(|dq| dq / factor).collect();
            let ddq: Vec<f64> = at.ddq.iter().map(|ddq| ddq / (factor * factor)).collect();
            for (i, worst) in worst.iter_mut().enumerate() {
                let need = dq[i].abs();
                worst.raise(Worst {
                    share: need / self.limits[i][1],
                    lack: Lack::Speed,
                    t,
                    need,
                    payload_kg: 0.0,
                });
            }
            if self.adds_gravity {
                self.own.bias(&mut own, &at.q, &zero, &mut gravity);
            }
            for (payload_kg, model, workspace) in &mut arms {
                model.inverse_dynamics(workspace, &at.q, &dq, &ddq, &mut tau);
                for (i, worst) in worst.iter_mut().enumerate() {
                    let friction = self.friction[i].torque(dq[i]) - self.helped[i].torque(dq[i]);
                    let need = (tau[i] - gravity[i] + friction).abs();
                    let share = need / self.limits[i][0];
                    worst.raise(Worst {
                        share,
                        lack: Lack::Torque,
                        t,
                        need,
                        payload_kg: *payload_kg,
                    });
                }
            }
        }
        worst
    }
}

impl Worst {
    fn raise(&mut self, other: Self) {
        if other.share > self.share {
            *self = other;
        }
    }
}
