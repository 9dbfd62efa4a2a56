//! Check that gains may run on an arm.

use phihat_certificate::extremes::{larger, smaller};
use phihat_study::Study;

use super::inside::inside;
use super::scope::unmodelled;
use super::start::start_inside_window;
use crate::Arm;
use crate::claims::law::holds;
use crate::claims::{Refutation, UnitLaw};
use crate::elastic::links_of;
use crate::prelude::*;
use crate::sampled::{InertiaWindow, LoopModel, StateMatrix};
use crate::{ArmBasis, Certificate, Gains, JointRecord};
use phihat_certificate::{ElasticJoints, FrozenArm};

/// Checks that gains may run on a study's arm: the inertia, over its postures and payloads, is inside the
/// sampled loop's window of every joint (that of its first-order start gains too, where the study starts with
/// them), the estimator is slow enough for the sample rate, and the loop contains nothing that its model
/// lacks. Gains with a certificate are armed as it says: over its range of inertia too, by its margin, and
/// not where it refuses a claim.
///
/// # Errors
///
/// The [`Refutation`] that forbids it.
///
/// # Example
///
/// ```
/// use phihat_design::{Arm, arm_inside_window, requested_gains};
/// use phihat_study::Study;
///
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     error_bound_rad = 2e-3
/// #     [gains]
/// #     order = 1
/// #     bandwidth_rad_s = 20.0
/// #     estimator_bandwidth_rad_s = 70.0
/// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     fade_in_s = 1.0
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// let arm = Arm::of(&study)?;
/// let mut gains = requested_gains(&study).ok_or("the study states no gains")?;
/// arm_inside_window(&study, &arm, &gains)?;
///
/// // With a twentieth of the nominal inertia the arm is too heavy for the window.
/// for joint in &mut gains.joints {
///     joint.inertia_kg_m2 /= 20.0;
/// }
/// let why = arm_inside_window(&study, &arm, &gains).unwrap_err();
/// assert!(why.claim.contains("inertia window"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn arm_inside_window(study: &Study, arm: &Arm, gains: &Gains) -> Result<(), Refutation> {
    let own_laws = shared_law(gains).is_err();
    let nominal = gains.joints.iter().map(|j| j.inertia_kg_m2).collect();
    let unknown = |why: crate::ArmError| Refutation {
        claim: "inertia window".to_owned(),
        inequality: format!("the arm's inertia is known ({why})"),
        left: 0.0,
        right: 0.0,
    };
    let mut arm = arm.against(nominal).map_err(unknown)?;
    let mut margin = 1.0;
    if let Some(certificate) = &gains.certificate {
        certificate.refused().map_or(Ok(()), Err)?;
        margin = certificate.window_margin.max(1.0);
        let told = certified_range(certificate, gains)?;
        (arm.low, arm.high) = (smaller(arm.low, told.0), larger(arm.high, told.1));
    }
    if own_laws && arm.basis == ArmBasis::Postures {
        let models = loop_models(study, gains);
        FrozenArm::stable(arm.low / margin, arm.high * margin).verify(&pairs(gains, &models))?;
    }
    for (i, record) in gains.joints.iter().enumerate() {
        let model = LoopModel::from_study(study, i).with_choices_of(gains, study);
        below_nyquist(record, model.period_s).map_err(|why| why.on(&record.name))?;
        InertiaWindow::find(record, &model)
            .and_then(|window| inside(&window, &arm, margin))
            .and_then(|()| unmodelled(study, i, (record, &model), &arm))
            .and_then(|()| start_inside_window(study, record, &model, &arm))
            .map_err(|why| why.on(&record.name))?;
    }
    bears_springs(study, gains)
}

/// That a law bears the springs of an arm whose joints bend, where the study states them.
fn bears_springs(study: &Study, gains: &Gains) -> Result<(), Refutation> {
    if study.springs.stated().is_none() {
        return Ok(());
    }
    let links = Arm::of(&links_of(study)).map_err(|why| Refutation {
        claim: "elastic joints".to_owned(),
        inequality: format!("the links' inertia is known ({why})"),
        left: 0.0,
        right: 0.0,
    })?;
    ElasticJoints::find(study, gains, &links).map(drop).map_err(|refusal| refusal.why)
}

/// Shares of the slowest pole's rate that are tried in turn as the rate of the coupled arm: each is proved or not.
const RATE_SHARES: [f64; 5] = [0.93, 0.8, 0.6, 0.4, 0.2];

/// Ratios of inertia over a range at which poles are looked at.
const POLES: u32 = 9;

/// That laws of their own hold a coupled arm at every posture of a range, and how fast it forgets there.
pub(super) fn frozen(
    study: &Study,
    gains: &Gains,
    (low, high): (f64, f64),
) -> Result<FrozenArm, Refutation> {
    let models = loop_models(study, gains);
    let loops = pairs(gains, &models);
    let ratio = |k: u32| low * libm::pow(high / low, f64::from(k) / f64::from(POLES - 1));
    let poles = loops.iter().flat_map(|(record, model)| {
        (0..POLES).map(move |k| StateMatrix::new(record, model, ratio(k)).decay_rate())
    });
    let slowest = poles.fold(f64::INFINITY, smaller);
    let rates = RATE_SHARES.iter().map(|share| share * slowest).filter(|rate| *rate > 0.0);
    let arms = rates.map(|rate| FrozenArm { low, high, decay_per_s: Some(rate) });
    if let Some(proved) = arms.into_iter().find(|arm| arm.verify(&loops).is_ok()) {
        return Ok(proved);
    }
    let arm = FrozenArm::stable(low, high);
    arm.verify(&loops)?;
    Ok(arm)
}

fn loop_models(study: &Study, gains: &Gains) -> Vec<LoopModel> {
    let of = |i: usize| LoopModel::from_study(study, i).with_choices_of(gains, study);
    (0..gains.joints.len()).map(of).collect()
}

fn pairs<'a>(gains: &'a Gains, models: &'a [LoopModel]) -> Vec<(&'a JointRecord, &'a LoopModel)> {
    gains.joints.iter().zip(models).collect()
}

/// The range of inertia that a certificate is about, in the gains' `M̄`.
fn certified_range(certificate: &Certificate, gains: &Gains) -> Result<(f64, f64), Refutation> {
    let told = &certificate.arm;
    let claim = "certificate";
    let counts = (told.nominal_kg_m2.len(), gains.joints.len());
    let all = counts.0 == counts.1;
    holds(claim, "one entry per joint", counts.0 as f64, counts.1 as f64, all)?;
    for (claimed, joint) in told.nominal_kg_m2.iter().zip(&gains.joints) {
        let used = joint.inertia_kg_m2;
        let equal = (claimed - used).abs() <= 1e-9 * used;
        holds(claim, "the arm is measured in the gains' M̄", *claimed, used, equal)
            .map_err(|why| why.on(&joint.name))?;
    }
    let (low, high) = (told.low, told.high);
    let range = 0.0 < low && low <= high && high < f64::INFINITY;
    holds(claim, "0 < low ≤ high < ∞ of the arm's inertia", low, high, range)?;
    Ok((low, high))
}

/// Poles beyond half the sample rate look like slow ones at the samples: stable in exact arithmetic, and so
/// far from normal that rounding errors alone are seen. The geometric mean of the estimator's poles is `a_0^(1/m)`.
fn below_nyquist(record: &JointRecord, period: f64) -> Result<(), Refutation> {
    if record.observer.is_some() {
        // Its poles are those of the samples.
        return Ok(());
    }
    let first = record.a.first().copied().unwrap_or(f64::NAN);
    let share = record.a.iter().fold(first, |share, _| share * period / core::f64::consts::PI);
    let inequality = "a_0 (T/π)^m < 1: the estimator's poles lie below half the sample rate";
    holds("estimator", inequality, share, 1.0, share < 1.0)
}

/// The eigenvalue argument for a coupled arm needs one law for all joints.
pub(super) fn shared_law(gains: &Gains) -> Result<(), Refutation> {
    let Some(first) = gains.joints.first() else { return Ok(()) };
    let law = UnitLaw::from(first);
    for joint in &gains.joints {
        let same = UnitLaw::from(joint) == law && joint.observer == first.observer;
        let claim = format!("{}: inertia window of the arm", joint.name);
        let inequality = "the law is that of the first joint (only M̄ may differ)";
        holds(&claim, inequality, joint.kp_per_s2, first.kp_per_s2, same)?;
    }
    Ok(())
}
