//! Scope of a certificate: properties of a study that forbid it, and those that its claims leave out.

use phihat_certificate::extremes::Extremes;
use phihat_study::{Flexibility, ReferenceRequest, SampleStamps, Study};

use crate::ArmInertia;
use crate::JointRecord;
use crate::claims::Refutation;
use crate::sampled::{LoopModel, stable_at_gain};

/// Properties of a study that must not be armed, because the loop model lacks them: key and value.
pub(crate) fn missing(study: &Study) -> Vec<(&'static str, f64)> {
    let bends = study.world.flexibility.as_ref().filter(|own| !within_stated(study, own));
    let spring = bends.map(|f| f.stiffness.iter().copied());
    let softest = spring.map(Extremes::least);
    let jitter = Some(study.sensor.jitter).filter(|jitter| *jitter > 0.0 && !misread(study));
    [
        ("world.flexibility.stiffness_nm_rad", softest),
        ("sensor.sample_jitter_s", jitter),
        ("profile.torque_filter_hz", study.interface.profile.torque_filter),
    ]
    .into_iter()
    .filter_map(|(key, value)| Some((key, value?)))
    .collect()
}

/// Returns true if jitter is an error of readings alone, as the bound for a class counts it: a law that knows of it
/// takes another interval, which the loop model lacks.
fn misread(study: &Study) -> bool {
    let class = matches!(study.reference, ReferenceRequest::Any { .. });
    class && (study.supervisor.is_none() || study.sensor.stamps == SampleStamps::Nominal)
}

/// Returns true if the springs of a world lie in the intervals that the study states, for which the certificate has a
/// clause.
fn within_stated(study: &Study, world: &Flexibility) -> bool {
    let Some(stated) = study.springs.stated() else { return false };
    let inside = |value: f64, (low, high): (f64, f64)| low <= value && value <= high;
    let all = stated.iter().zip(&world.stiffness).zip(&world.damping);
    let mut springs = all.map(|((own, k), c)| inside(*k, own.stiffness) && inside(*c, own.damping));
    springs.all(|holds| holds) && world.backlash.iter().all(|play| *play <= 0.0)
}

/// The study without what the loop model lacks; `None` where it lacks nothing.
pub(crate) fn as_modelled(study: &Study) -> Option<Study> {
    let rigid = study.world.flexibility.is_none();
    if rigid
        && missing(study).is_empty()
        && (0..study.robot.joints.len()).all(|i| gains(study, i).is_none())
    {
        return None;
    }
    let mut study = study.clone();
    study.world.flexibility = None;
    study.world.drive = None;
    study.sensor.jitter = 0.0;
    study.interface.profile.torque_filter = None;
    Some(study)
}

/// Why no claim about a joint's sampled loop can be made although the loop model says yes.
pub(super) fn unmodelled(
    study: &Study,
    joint: usize,
    (record, model): (&JointRecord, &LoopModel),
    arm: &ArmInertia,
) -> Result<(), Refutation> {
    if let Some((key, value)) = missing(study).first() {
        return Err(Refutation {
            claim: "loop model".to_owned(),
            inequality: format!("no `{key}` in the study: it is in the loop, and not in its model"),
            left: *value,
            right: 0.0,
        });
    }
    let Some((least, most)) = gains(study, joint) else { return Ok(()) };
    for gain in [least, 0.5 * (least + most), most] {
        stable_at_gain(record, model, gain, (arm.low, arm.high))?;
    }
    Ok(())
}

/// Least and largest gain of a drive over the run; `None` where it is 1.
pub(super) fn gains(study: &Study, joint: usize) -> Option<(f64, f64)> {
    let drive = study.world.drive.as_ref()?;
    let part = drive.gain_error[joint] + drive.ripple[joint];
    let drift = drive.gain_drift[joint] * study.duration;
    let ends = [-part + drift.min(0.0), part + drift.max(0.0)];
    let [a, b] = ends.map(|share| drive.gain[joint] * (1.0 + share));
    let exact = (a - 1.0).abs() + (b - 1.0).abs() == 0.0;
    (!exact).then_some((a.min(b), a.max(b)))
}
