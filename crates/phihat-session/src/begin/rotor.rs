//! The smallest rotor inertia with which there are gains, found by trying.

use phihat_study::Study;

use crate::error::SessionError;

/// Rotor inertias that are tried \[kg·m²\], and how often the gap between two is halved.
const LEAST: f64 = 1e-6;
const MOST: f64 = 1e3;
const STEPS: u32 = 9;
const HALVINGS: u32 = 5;

/// A sentence that says which rotor inertia, on the joints that have less, makes gains possible; `None` where none does.
///
/// # Errors
///
/// Those of `has_gains`, which says whether a study has some for any error.
pub(super) fn smallest_rotor(
    study: &Study,
    has_gains: &dyn Fn(&Study) -> Result<bool, SessionError>,
) -> Result<Option<String>, SessionError> {
    let with = |least: f64| {
        let mut own = study.clone();
        for joint in &mut own.robot.joints {
            joint.armature = joint.armature.max(least);
            joint.armature_range =
                joint.armature_range.map(|(low, high)| (low.max(least), high.max(least)));
        }
        has_gains(&own)
    };
    let factor = (MOST / LEAST).powf(1.0 / f64::from(STEPS));
    let mut before = LEAST;
    for step in 0..=STEPS {
        let mut high = LEAST * factor.powf(f64::from(step));
        if !with(high)? {
            before = high;
            continue;
        }
        for _ in 0..HALVINGS {
            let middle = (before * high).sqrt();
            if with(middle)? { high = middle } else { before = middle }
        }
        return Ok(Some(told(study, high)));
    }
    Ok(None)
}

fn told(study: &Study, least: f64) -> String {
    let lacking = study
        .robot
        .joints
        .iter()
        .filter(|joint| joint.armature_range.map_or(joint.armature, |(low, _)| low) < least);
    let lacking: Vec<String> = lacking
        .map(|joint| {
            let own = joint.armature_range.map_or(joint.armature, |(low, _)| low);
            format!("{} ({own:.2e})", joint.name)
        })
        .collect();
    format!(
        "light joints have no rotor: with a rotor inertia of at least {least:.2e} kg·m² on every joint there are gains, and {} \
         have less. One constant inertia per joint must stand for the arm in every posture; a rotor, which does not change, \
         makes it more nearly constant. State armature_kg_m2 (rotor inertia times the gear ratio squared), or a smaller \
         --payload, a faster loop, less delay",
        lacking.join(", ")
    )
}
