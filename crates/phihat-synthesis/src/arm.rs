//! The arm's range of inertia, from the source that a study names.

use phihat_design::{Arm, JointSignals, estimate_inertia, typed_inertia_holds};
use phihat_study::{InertiaSource, Study};

use crate::along::arm_along;
use crate::error::SynthesisError;
use crate::recordings::{Recordings, required};

/// The arm from the source that its study names: description, typed inertia, or a recording.
///
/// # Errors
///
/// [`SynthesisError`]: the source cannot be used, or contradicts the robot's description.
pub fn arm(study: &Study, recordings: &Recordings) -> Result<Arm, SynthesisError> {
    typed_inertia_holds(study)?;
    let InertiaSource::Trace(file) = &study.design.inertia else { return Ok(arm_along(study)?) };
    let recording = required(recordings.inertia.as_ref(), file)?;
    let signals = recording.trace.joints.iter().map(|joint| JointSignals {
        name: &joint.name,
        q: &joint.q,
        dq: &joint.dq,
        ddq: &joint.ddq,
        tau: &joint.tau_applied,
    });
    let signals: Vec<_> = signals.collect();
    let estimates = estimate_inertia(&signals, recording.trace.period_ns);
    // The message names the file as the study does.
    let failed = |why| SynthesisError::Estimate { file: file.clone(), why };
    estimates.map(|estimates| Arm::estimated(&estimates)).map_err(failed)
}
