//! The arm's range of inertia, from the source that a study names.

use phihat_design::{Arm, EstimateError, RecordedJoint, enclose_inertia, typed_inertia_holds};
use phihat_study::{InertiaSource, Study};

use crate::along::arm_along;
use crate::error::SynthesisError;
use crate::recordings::{Recordings, required};

/// Width of the boxes that recorded positions are differenced over \[s\].
const WIDTH: f64 = 0.01;

/// The arm from the source that its study names: description, typed inertia, or a recording.
///
/// # Errors
///
/// [`SynthesisError`]: the source cannot be used, or contradicts the robot's description.
pub fn arm(study: &Study, recordings: &Recordings) -> Result<Arm, SynthesisError> {
    typed_inertia_holds(study)?;
    let InertiaSource::Trace(file) = &study.design.inertia else { return Ok(arm_along(study)?) };
    let recording = required(recordings.inertia.as_ref(), file)?;
    let joints = recording.trace.joints.iter().map(|joint| RecordedJoint {
        name: joint.name.clone(),
        q: joint.q_measured.clone(),
        tau: joint.tau_applied.clone(),
    });
    let joints: Vec<_> = joints.collect();
    let estimates = enclose_inertia(&joints, recording.trace.period_ns, WIDTH).and_then(|found| {
        let all = found.into_iter().zip(&joints).map(|(found, joint)| {
            let joint = joint.name.clone();
            found.map_err(|why| EstimateError::Undetermined { joint, why })
        });
        all.collect::<Result<Vec<_>, _>>()
    });
    // The message names the file as the study does.
    let failed = |why| SynthesisError::Estimate { file: file.clone(), why };
    estimates.map(|estimates| Arm::estimated(&estimates)).map_err(failed)
}
