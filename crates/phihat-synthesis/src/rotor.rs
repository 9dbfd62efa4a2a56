//! The smallest rotor inertia with which there are gains, found by trying.

use phihat::Form;
use phihat_design::{Alternative, Arm, DesignError, Outcome, PhiOf, has_law, search};
use phihat_sim::Demand;
use phihat_study::{DesignMethod, Study};

use crate::along::{arm_along, phi_along};
use crate::digits;
use crate::error::SynthesisError;

/// Rotor inertias that are tried \[kg·m²\], and how often the gap between two is halved.
const LEAST: f64 = 1e-6;
const MOST: f64 = 1e3;
const STEPS: u32 = 9;
const HALVINGS: u32 = 5;

/// Number of larger values tried where the estimate is not certified, and the factor between them.
const CERTIFIED: u32 = 4;
const MORE: f64 = 1.05;

/// Allowed error where any error is acceptable \[rad, m\].
const ANY: f64 = 50.0;

/// Key of a study that states rotors.
const KEY: &str = "robot.armature_kg_m2";

/// One search by bounds of joint after joint, for `φ` along the reference.
///
/// # Errors
///
/// [`SynthesisError`]: the arm cannot follow its reference, or the search not begin.
pub fn one_search(study: &Study, arm: &Arm) -> Result<Outcome, SynthesisError> {
    sought(study, |phi| search(study, arm, phi))
}

/// Result of a search for a study, with φ along its reference.
fn sought<T>(
    study: &Study,
    find: impl FnOnce(PhiOf<'_>) -> Result<T, DesignError>,
) -> Result<T, SynthesisError> {
    let demand = Demand::along(study)?;
    Ok(find(&|joint, inertia| phi_along(&demand, joint, inertia))?)
}

/// The study, with any error allowed.
fn easy(study: &Study) -> Study {
    let mut easy = study.clone();
    easy.spec.error_bound = Some(vec![ANY; study.robot.joints.len()]);
    (easy.spec.velocity_error_bound, easy.spec.error_integral_bound) = (None, None);
    easy
}

/// The order of a law for whatever error, by the search's own estimates: quick, and no proof.
///
/// # Errors
///
/// As [`one_search`].
pub fn any_law(study: &Study, arm: &Arm) -> Result<Option<usize>, SynthesisError> {
    if study.control.form == Form::Positions || study.design.method != DesignMethod::Ours {
        return any_gains(study, arm);
    }
    let easy = easy(study);
    sought(&easy, |phi| has_law(&easy, arm, phi))
}

/// The order of gains for whatever error; `None`: no law keeps the arm inside its window with the margins.
///
/// # Errors
///
/// As [`one_search`].
fn any_gains(study: &Study, arm: &Arm) -> Result<Option<usize>, SynthesisError> {
    match one_search(&easy(study), arm)? {
        Outcome::Designed(gains) => Ok(gains.joints.first().map(|joint| joint.a.len())),
        Outcome::Infeasible(_) => Ok(None),
    }
}

/// The smallest rotor inertia that, where joints have less, makes gains possible; `None` where none does.
///
/// # Errors
///
/// As [`one_search`].
pub fn smallest_rotor(study: &Study) -> Result<Option<Alternative>, SynthesisError> {
    let with = |least: f64| -> Study {
        let mut own = study.clone();
        for joint in &mut own.robot.joints {
            joint.armature = joint.armature.max(least);
            joint.armature_range =
                joint.armature_range.map(|(low, high)| (low.max(least), high.max(least)));
        }
        own
    };
    let law = |least: f64| {
        let own = with(least);
        any_law(&own, &arm_along(&own)?)
    };
    let gains = |least: f64| {
        let own = with(least);
        any_gains(&own, &arm_along(&own)?)
    };
    let factor = libm::pow(MOST / LEAST, 1.0 / f64::from(STEPS));
    let mut before = LEAST;
    for step in 0..=STEPS {
        let mut value = LEAST * libm::pow(factor, f64::from(step));
        if law(value)?.is_none() {
            before = value;
            continue;
        }
        for _ in 0..HALVINGS {
            let middle = (before * value).sqrt();
            match law(middle)? {
                Some(_) => value = middle,
                None => before = middle,
            }
        }
        return rounded(value, &gains);
    }
    Ok(None)
}

/// Three digits, upwards, with gains that are certified: somewhat more where those that were estimated are not.
fn rounded(
    value: f64,
    gains: &dyn Fn(f64) -> Result<Option<usize>, SynthesisError>,
) -> Result<Option<Alternative>, SynthesisError> {
    let mut up = digits::up(value, 3);
    for _ in 0..CERTIFIED {
        if let Some(order) = gains(up)? {
            return Ok(Some(Alternative { key: KEY.to_owned(), value: up, order }));
        }
        up = digits::up(MORE * up, 3);
    }
    Ok(None)
}

/// Text about the joints whose rotor inertia is below the least for which there are gains.
pub fn lacking(study: &Study, least: f64) -> String {
    let own =
        |joint: &phihat_model::Joint| joint.armature_range.map_or(joint.armature, |(low, _)| low);
    let joints = study.robot.joints.iter().filter(|joint| own(joint) < least);
    let joints: Vec<String> =
        joints.map(|joint| format!("{} ({:.2e})", joint.name, own(joint))).collect();
    format!(
        "light joints have no rotor: with a rotor inertia of at least {least:.2e} kg·m² on every joint there are \
         gains, and these have less: {}. One constant inertia per joint must stand for the arm in every posture; a \
         rotor, which does not change, makes it more nearly constant. State armature_kg_m2 (rotor inertia times the \
         gear ratio squared), or a smaller payload, a faster loop, less delay",
        joints.join(", ")
    )
}
