//! Finding the claim of elastic joints, or what a user has to know where it does not hold.

use core::f64::consts::TAU;

use phihat_certificate::{ElasticJoint, ElasticJoints, EncoderSide};
use phihat_model::{Joint, JointSpring, Rotor};
use phihat_study::{InertiaSource, Study};

use super::grid::{Gap, LawInLoop, SpringGrid};
use super::refusal::{ElasticRefusal, SpringNeeds, SpringRefusal};
use super::softest::Unsprung;
use crate::claims::Refutation;
use crate::sampled::LoopModel;
use crate::{Arm, Gains};

/// Steps of the frequencies that are tried: at stated springs, and where the springs themselves are sought.
const FINE: f64 = 0.004;
const COARSE: f64 = 0.015;

/// Frequency of the rotor of a sliding joint on a spring that nothing is known of \[rad/s\].
const UNKNOWN: f64 = 20.0 * TAU;

/// Moduli that are tried, from the largest.
const MODULI: [f64; 8] = [0.5, 0.4, 0.3, 0.2, 0.15, 0.1, 0.05, 0.02];

/// A study's arm without its rotors: the links on the springs of its joints.
pub fn links_of(study: &Study) -> Study {
    let mut links = study.clone();
    links.robot = links.robot.links_alone();
    links
}

/// Finding the clause of elastic joints.
pub trait FindElastic: Sized {
    /// The clause for gains of a study that states the springs of its joints, with the largest modulus of a list;
    /// `None`: it does not. `links` is the arm of [`links_of`] the study.
    ///
    /// # Method
    ///
    /// Frequencies by steps of 0.4 %, stiffness by steps of 2 %, damping and rotor at both ends: where one circle
    /// serves all joints at each of them, the claim is made, and shown by its own check.
    ///
    /// # Errors
    ///
    /// [`ElasticRefusal`], with what this law needs and what else would do.
    fn find(study: &Study, gains: &Gains, links: &Arm)
    -> Result<Option<Self>, Box<ElasticRefusal>>;
}

impl FindElastic for ElasticJoints {
    fn find(
        study: &Study,
        gains: &Gains,
        links: &Arm,
    ) -> Result<Option<Self>, Box<ElasticRefusal>> {
        let Some(joints) = ElasticJoint::of(study) else { return Ok(None) };
        let clauses = clauses((study, gains), links, &joints).map_err(Box::new)?;
        let mut unshown = None;
        for clause in clauses {
            match shown(&clause, study, gains) {
                Ok(()) => return Ok(Some(with_modulus(clause, study, gains))),
                Err(why) => unshown = unshown.or(Some((clause, why))),
            }
        }
        Err(Box::new(match unshown {
            Some((clause, why)) => refused(&clause, (study, gains), links, why),
            None => ElasticRefusal::unknown("the links' inertia is known"),
        }))
    }
}

/// The clause with the largest modulus of a list that its check shows.
fn with_modulus(clause: ElasticJoints, study: &Study, gains: &Gains) -> ElasticJoints {
    let models = models(study, gains);
    let larger = |modulus: &f64| {
        let tried = ElasticJoints { modulus: *modulus, ..clause.clone() };
        tried.verify(&looped(gains, &models)).is_ok().then_some(tried)
    };
    MODULI.iter().find_map(larger).unwrap_or(clause)
}

/// Least stiffness of each joint \[N·m/rad\] with which gains of a study are stable on a grid of frequencies, all
/// joints together, each anywhere up to [`SPREAD`] times its own, with 1 % of critical damping: SEARCHED, and no claim.
/// `None`: not even rigid by this theorem, a rotor is not known, or the arm's inertia is not that of a description.
pub fn softest_springs(study: &Study, gains: &Gains, links: &Arm) -> Option<Vec<f64>> {
    let own = clauses((study, gains), links, &[]).ok()?.into_iter().next()?;
    let rotor: Vec<f64> =
        study.robot.joints.iter().map(|joint| joint.armature_at(Rotor::Least)).collect();
    let known = rotor.iter().all(|rotor| *rotor > 0.0);
    known.then(|| softest(&own, (study, gains), &rotor)).flatten()
}

/// Clauses of a study's arm with these joints, not shown yet, or what is not known: the links' range in units of each
/// joint's own largest link inertia, where a circle loses least with encoders at the links, and in the gains' `M̄`,
/// where it does with encoders at the motors, in that order or the opposite.
fn clauses(
    (study, gains): (&Study, &Gains),
    links: &Arm,
    joints: &[ElasticJoint],
) -> Result<Vec<ElasticJoints>, ElasticRefusal> {
    if study.design.inertia != InertiaSource::Robot {
        let what = "the links' inertia is that of the robot's description (design.inertia)";
        return Err(ElasticRefusal::unknown(what));
    }
    let encoder = EncoderSide::of(study);
    let heaviest: Vec<f64> = links.diagonal().iter().map(|(_, heavy)| *heavy).collect();
    let nominal: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let units = match encoder {
        EncoderSide::Link => [heaviest, nominal],
        EncoderSide::Motor => [nominal, heaviest],
    };
    let margin = study.design.window_margin.max(1.0);
    let clause = |unit: Vec<f64>| {
        let range = links.against(unit).map_err(|why| {
            ElasticRefusal::unknown(&format!("the links' inertia is known ({why})"))
        })?;
        Ok(ElasticJoints {
            encoder,
            modulus: 0.0,
            low: range.low / margin,
            high: range.high * margin,
            links: range,
            joints: joints.to_vec(),
        })
    };
    units.into_iter().map(clause).collect()
}

/// Loop model of every joint.
fn models(study: &Study, gains: &Gains) -> Vec<LoopModel> {
    (0..gains.joints.len())
        .map(|i| LoopModel::from_study(study, i).with_choices_of(gains, study))
        .collect()
}

fn looped<'a>(gains: &'a Gains, models: &'a [LoopModel]) -> Vec<LawInLoop<'a>> {
    gains.joints.iter().zip(models).collect()
}

/// Least stiffness of each joint that is borne, on a coarse grid.
fn softest(
    clause: &ElasticJoints,
    (study, gains): (&Study, &Gains),
    rotor: &[f64],
) -> Option<Vec<f64>> {
    let models = models(study, gains);
    let grid = &SpringGrid::new(&looped(gains, &models), &clause.links.nominal_kg_m2, COARSE);
    let usual = |(joint, rotor): (&Joint, &f64)| {
        let spring = joint.spring.or_else(|| JointSpring::assumed(joint));
        spring.map_or(rotor * UNKNOWN * UNKNOWN, |own| own.stiffness.0)
    };
    let usual: Vec<f64> = study.robot.joints.iter().zip(rotor).map(usual).collect();
    let range = (clause.low, clause.high);
    Unsprung { grid, side: clause.encoder, range, rotor, usual: &usual }.softest()
}

/// Reason why the clause does not hold: a gap of the search, or a failure of the check.
enum Unshown {
    Gap(Gap),
    Check(Refutation),
}

fn shown(clause: &ElasticJoints, study: &Study, gains: &Gains) -> Result<(), Unshown> {
    let models = models(study, gains);
    let loops = looped(gains, &models);
    let request = (clause.encoder, (clause.low, clause.high));
    let unit = &clause.links.nominal_kg_m2;
    if let Some(gap) = SpringGrid::new(&loops, unit, FINE).gap(&clause.joints, request) {
        return Err(Unshown::Gap(gap));
    }
    clause.verify(&loops).map_err(Unshown::Check)
}

/// SpringNeeds of the law, and what else would do.
fn refused(
    clause: &ElasticJoints,
    (study, gains): (&Study, &Gains),
    links: &Arm,
    why: Unshown,
) -> ElasticRefusal {
    let gap = match why {
        Unshown::Gap(gap) => gap,
        Unshown::Check(why) => return ElasticRefusal::of(why),
    };
    let (first, second) = gap.joints;
    let mut blamed = vec![first];
    if second != first {
        blamed.push(second);
    }
    let rotor: Vec<f64> = clause.joints.iter().map(|joint| joint.rotor_kg_m2.0).collect();
    let softest = softest(clause, (study, gains), &rotor);
    let inertia = links.diagonal();
    let needs = |joint: &usize| {
        let own = &clause.joints[*joint];
        let (light, heavy) = inertia.get(*joint).copied().unwrap_or((f64::NAN, f64::NAN));
        let hz = |stiffness: f64, rotor: f64, link: f64| {
            (stiffness * (1.0 / rotor + 1.0 / link)).sqrt() / TAU
        };
        let (low, high) = (own.stiffness_nm_rad.0, own.stiffest());
        SpringNeeds {
            joint: gains.joints[*joint].name.clone(),
            stiffness_nm_rad: (low, high),
            resonance_hz: (hz(low, own.rotor_kg_m2.1, heavy), hz(high, own.rotor_kg_m2.0, light)),
            stiffer_than: softest.as_ref().map(|all| all[*joint]),
        }
    };
    let what = format!(
        "one circle through −{:.5} and −{:.5} has every L″ outside from {:.3} to {:.3} Hz",
        clause.low, clause.high, gap.hz.0, gap.hz.1
    );
    let why = Refutation {
        claim: format!("{}: elastic joints", gains.joints[first].name),
        inequality: what,
        left: 0.0,
        right: 1.0,
    };
    let other = ElasticJoints { encoder: clause.encoder.other(), ..clause.clone() };
    let refused = SpringRefusal {
        encoder: clause.encoder,
        band_hz: gap.hz,
        needs: blamed.iter().map(needs).collect(),
        other_side: shown(&other, study, gains).is_ok(),
    };
    ElasticRefusal { why, refused: Some(refused) }
}
