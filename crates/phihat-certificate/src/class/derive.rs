//! The bound for a class, derived a second time: kicks played at the witnesses and at postures that nobody knew before.

use phihat_model::{Body, Model};
use phihat_study::{ReferenceRequest, Study};
use serde::Serialize;

use super::bends::{ClassBends, MARGIN};
use super::document::ClassBound;
use super::dynamics::Dynamics;
use super::maxima::Maxima;
use super::places::PostureDice;
use super::setting::{CLAIM, ClassSetting, bodies, models, rotors};
use super::solve::{BoundProblem, PlayedPosture, Solution};
use super::sums::PlayedSums;
use crate::check::plausible::at_most;
use crate::clauses::{LimitClause, listed};
use crate::extremes::{Extremes as _, larger};
use crate::loaded::loaded;
use crate::parallel::{both, shared, threads};
use crate::refutation::refuse;
use crate::{Certificate, Gains, JointRecord, LoopModel, Refutation};

/// Postures drawn from the seed at which kicks are played, beside the witnesses.
const PLAYED: usize = 64;

/// Postures drawn from the seed at which second derivatives are looked at, with one payload each, beside those.
const BENT: usize = 96;

/// A bound and the same one as a second derivation gives it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ClassPair {
    /// Bound in the file.
    pub claimed: f64,
    /// Bound derived here.
    pub derived: f64,
}

impl ClassPair {
    /// The wider of both: the bound that two derivations show.
    #[must_use]
    pub fn wider(self) -> f64 {
        larger(self.claimed, self.derived)
    }

    /// Derived over claimed: at most 1 where the derivation confirms the claim.
    #[must_use]
    pub fn ratio(self) -> f64 {
        self.derived / self.claimed
    }
}

/// A joint's bounds beside those that a second derivation gives.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointOfClass {
    /// Joint name.
    pub name: String,
    /// Bound on `|e|` \[rad\].
    pub error_bound_rad: ClassPair,
    /// Bound on `|ė|` \[rad/s\].
    pub velocity_error_bound_rad_s: ClassPair,
    /// Bound on the change of the commanded torque per sample \[N·m\].
    pub torque_step_nm: ClassPair,
    /// Bound on the torque \[N·m\].
    pub torque_nm: ClassPair,
}

impl JointOfClass {
    fn pairs(&self) -> [ClassPair; 4] {
        let Self { error_bound_rad, velocity_error_bound_rad_s, torque_step_nm, torque_nm, .. } =
            *self;
        [error_bound_rad, velocity_error_bound_rad_s, torque_step_nm, torque_nm]
    }
}

/// Result of a second derivation of a bound for a class.
///
/// # Method
///
/// (CM2) to (CM7) of docs/theory/class.md once more, by means of this crate. Impulses, misreadings and starts are
/// played through the checker's own loop at the file's witnesses and at postures that a seed decides, with every
/// payload in turn; what comes after the played time is bounded by a power of the loop's matrix. Coriolis torque is
/// taken from inverse dynamics, second derivatives from differences of the inertia and of gravity's torque.
///
/// # Not claimed
///
/// Maxima over box and payloads are the largest of a search of its own (assumption C8): of torque rates as they are, of
/// derivatives of the dynamics times [`ClassAgain::margin`]. Sums are in double precision.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassAgain {
    /// Why no bound could be derived a second time: the file's is on trust. `None`: it was.
    pub on_trust: Option<String>,
    /// Claimed beside derived, joint by joint; empty where it is on trust.
    pub joints: Vec<JointOfClass>,
    /// Clauses of the study's specification that the wider of both bounds does not keep, but for those that the file
    /// lists itself.
    pub unkept: Vec<String>,
    /// Limits of torque or torque rate that could act by the derived bounds, which are none then.
    pub limits_acting: Vec<String>,
    /// Postures at which kicks were played.
    pub postures: usize,
    /// Postures at which second derivatives were looked at.
    pub bent_postures: usize,
    /// Points of the class at which torque rates were looked at.
    pub points: usize,
    /// Factor on the largest derivatives that were found.
    pub margin: f64,
}

impl ClassAgain {
    /// The largest of derived over claimed `|e|`: at most 1 where every joint's is confirmed.
    pub fn largest_ratio(&self) -> f64 {
        self.joints.iter().map(|joint| joint.error_bound_rad.ratio()).largest()
    }

    /// The named assumption on which a bound rests that two derivations give, with its numbers.
    #[must_use]
    pub fn assumption(&self) -> String {
        format!(
            "assumption C8, maxima are no larger than two searches found them: here torque rates at {} points, kicks \
             at {} postures, second derivatives at {} with a factor of {}, drawn from this file's SHA-256 and --seed",
            self.points, self.postures, self.bent_postures, self.margin
        )
    }

    /// Returns true if every bound of every joint in the file is at least the derived one.
    pub fn confirmed(&self) -> bool {
        let pairs = || self.joints.iter().flat_map(JointOfClass::pairs);
        self.on_trust.is_none() && pairs().all(|pair| pair.derived <= pair.claimed)
    }
}

/// A posture at which kicks are played: the arm with its payload, and its place.
pub(super) type PlacedModel = (Model, Vec<f64>);

impl Certificate {
    /// Derives the bound for a class again, and holds the file's against it; `None`: the file has none.
    ///
    /// `seed` decides which postures and points are looked at: of the SHA-256 of the file and a number of the reader's.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: it is about another study, or claims less than what is derived without any term of second order.
    pub fn derive_class(
        &self,
        gains: &Gains,
        study: &Study,
        seed: u64,
    ) -> Result<Option<ClassAgain>, Refutation> {
        let Some(claimed) = &self.class else { return Ok(None) };
        let ReferenceRequest::Any { class, .. } = &study.reference else {
            return Err(refuse(CLAIM, "the study's reference is a class of motions", 0.0, 1.0));
        };
        let loop_models: Vec<LoopModel> = self.joints.iter().map(|joint| joint.model).collect();
        let setting = ClassSetting::of(study, gains, class, &loop_models)?;
        setting.is_of(claimed, study)?;
        let mut dice = PostureDice::new(seed);
        let models = models(study)?;
        let mut placed = witnesses(study, claimed)?;
        placed.extend(drawn(&models, PLAYED, || dice.place(class)));
        let bent = drawn(&models, BENT, || dice.place(class));
        let loops: Vec<(&JointRecord, &LoopModel)> =
            gains.joints.iter().zip(&loop_models).collect();
        let maxima = || Maxima::of(&setting.torques(), &models, &mut dice);
        let (maxima, (all, bends)) = both(threads(), maxima, || {
            let all = shared(placed.len(), |at| setting.played(&loops, &placed[at]));
            (all, setting.bends(&placed, &bent))
        });
        let all: Vec<PlayedPosture> = all.into_iter().collect::<Result<_, Refutation>>()?;
        let start = setting.start.imbalance((&maxima, claimed), (study, MARGIN))?;
        let of = |bends: &ClassBends| {
            let start = (start.clone(), claimed.start_s);
            BoundProblem { setting: &setting, maxima: &maxima, bends, start }.solve(&all)
        };
        refuted(&of(&ClassBends::none(setting.n))?, claimed, gains)?;
        let counts = (all.len(), bends.postures, maxima.points);
        let again = match of(&bends) {
            Ok(own) => beside((claimed, &own), (self, gains, study), counts),
            Err(why) => ClassAgain { on_trust: Some(why.to_string()), ..again(counts) },
        };
        Ok(Some(again))
    }
}

/// Refuses bounds below those that leave out every derivative of second order, whose answers are shorter by the
/// iteration's own margin.
fn refuted(least: &Solution, claimed: &ClassBound, gains: &Gains) -> Result<(), Refutation> {
    let lists = [
        ("derived |e| ≤ claimed", &least.error, &claimed.error_bound_rad),
        ("derived |ė| ≤ claimed", &least.velocity, &claimed.velocity_error_bound_rad_s),
        ("derived torque step ≤ claimed", &least.step, &claimed.torque_step_nm),
    ];
    for (what, derived, claimed) in lists {
        for ((derived, claimed), record) in derived.iter().zip(claimed).zip(&gains.joints) {
            at_most(CLAIM, what, derived / ROOM, *claimed).map_err(|why| why.on(&record.name))?;
        }
    }
    Ok(())
}

/// Room of [`refuted`]: by so much two searches for maxima may differ that are both honest.
const ROOM: f64 = 1.1;

/// A derivation that has found nothing yet.
fn again((postures, bent_postures, points): (usize, usize, usize)) -> ClassAgain {
    ClassAgain {
        on_trust: None,
        joints: Vec::new(),
        unkept: Vec::new(),
        limits_acting: Vec::new(),
        postures,
        bent_postures,
        points,
        margin: MARGIN,
    }
}

/// Claimed beside derived.
fn beside(
    (claimed, own): (&ClassBound, &Solution),
    (certificate, gains, study): (&Certificate, &Gains, &Study),
    counts: (usize, usize, usize),
) -> ClassAgain {
    let pair = |claimed: &[f64], derived: &[f64], i: usize| ClassPair {
        claimed: claimed[i],
        derived: derived[i],
    };
    let joints = gains.joints.iter().enumerate().map(|(i, record)| JointOfClass {
        name: record.name.clone(),
        error_bound_rad: pair(&claimed.error_bound_rad, &own.error, i),
        velocity_error_bound_rad_s: pair(&claimed.velocity_error_bound_rad_s, &own.velocity, i),
        torque_step_nm: pair(&claimed.torque_step_nm, &own.step, i),
        torque_nm: pair(&claimed.torque_nm, &own.torque, i),
    });
    let joints: Vec<JointOfClass> = joints.collect();
    let [unkept, limits_acting] = unkept(&joints, certificate, study);
    ClassAgain { joints, unkept, limits_acting, ..again(counts) }
}

/// Clauses of the specification that the wider bounds do not keep; and limits of the arm that could act by the derived
/// ones.
fn unkept(joints: &[JointOfClass], certificate: &Certificate, study: &Study) -> [Vec<String>; 2] {
    let of = |list: &Option<Vec<f64>>, i: usize| list.as_ref().and_then(|all| all.get(i)).copied();
    let beyond = |own: f64, limit: f64| own.is_nan() || own > limit;
    let [mut clauses, mut limits] = [Vec::new(), Vec::new()];
    for (i, (joint, record)) in joints.iter().zip(&certificate.joints).enumerate() {
        let JointOfClass { name, error_bound_rad, velocity_error_bound_rad_s, .. } = joint;
        let step = joint.torque_step_nm;
        let (spec, design) = (&study.spec, &study.design);
        for (key, limit, pair) in [
            ("spec.error_bound_rad", of(&spec.error_bound, i), *error_bound_rad),
            (
                "spec.velocity_error_bound_rad_s",
                of(&spec.velocity_error_bound, i),
                *velocity_error_bound_rad_s,
            ),
            ("design.torque_step_max_nm", of(&design.torque_step_max, i), step),
        ] {
            let sides = (pair.claimed, pair.derived);
            clauses.extend(limit.and_then(|limit| {
                LimitClause { key, limit, joint: Some(name.as_str()) }.unkept(sides)
            }));
        }
        let (torque, rate) = record.limits;
        let rate = rate.map(|rate| rate * record.model.period_s);
        for (what, limit, own) in
            [("torque", torque, joint.torque_nm.derived), ("torque step", rate, step.derived)]
        {
            limits.extend(limit.filter(|limit| beyond(own, *limit)).map(|limit| {
                format!("the {what} of {name} may reach its limit: {own:.4} N·m of {limit:.4}")
            }));
        }
    }
    clauses.retain(|line| !listed(line, &certificate.unproved));
    [clauses, limits]
}

/// The arm at the file's witnesses, with rotors at both ends of their intervals.
fn witnesses(study: &Study, claimed: &ClassBound) -> Result<Vec<PlacedModel>, Refutation> {
    let bodies = bodies(study);
    let mut placed = Vec::new();
    for witness in &claimed.witnesses {
        let body = witness.payload.as_ref().map(|p| Body {
            mass: p.mass_kg,
            com: p.com_m,
            inertia: p.inertia_kg_m2,
        });
        let body = body.unwrap_or(Body { mass: 0.0, com: [0.0; 3], inertia: [0.0; 6] });
        let known = body.mass <= 0.0 || bodies.iter().any(|(_, own)| *own == body);
        Refutation::unless(CLAIM, "a witness carries a payload of the set", 0.0, 1.0, known)?;
        let frame = witness.payload.as_ref().map_or("", |p| p.frame.as_str());
        for rotor in rotors(study) {
            let model = loaded(study, (*rotor, &body), frame)?.with_gravity(study.world.gravity);
            placed.push((model, witness.q_rad.clone()));
        }
    }
    Ok(placed)
}

/// So many postures that are drawn, with the models in turn.
fn drawn(models: &[Model], count: usize, mut place: impl FnMut() -> Vec<f64>) -> Vec<PlacedModel> {
    models.iter().cycle().take(count).map(|model| (model.clone(), place())).collect()
}

impl ClassSetting<'_> {
    pub(super) fn played(
        &self,
        loops: &[(&JointRecord, &LoopModel)],
        (model, q): &PlacedModel,
    ) -> Result<PlayedPosture, Refutation> {
        let dynamics = Dynamics::at(model, self.added.as_ref(), q);
        let inverse = crate::coupled::inverse(&dynamics.mass, self.n)?;
        let sums = PlayedSums::at(loops, (&dynamics, &inverse), (self.period, self.rows))?;
        let sizes = |m: &crate::Matrix| m.iter().flatten().map(|x| x.abs()).collect();
        Ok(PlayedPosture { sums, inverse: sizes(&inverse) })
    }

    /// Maxima of derivatives over the postures, with their margin.
    pub(super) fn bends(&self, placed: &[PlacedModel], more: &[PlacedModel]) -> ClassBends {
        let all: Vec<&PlacedModel> = placed.iter().chain(more).collect();
        let found = shared(all.len(), |at| {
            let (model, q) = all[at];
            ClassBends::at((model, self.added.as_ref()), self.class, q)
        });
        let mut most = ClassBends::none(self.n);
        for own in found {
            most.and(own);
        }
        most.times(MARGIN)
    }
}
