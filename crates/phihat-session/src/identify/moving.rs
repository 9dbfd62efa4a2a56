//! One joint of an arm that moved while the others were held.

use phihat_design::{EstimateError, RecordedJoint, Smoothed, enclose_inertia};

use super::{IdentifiedJoint, IdentifyOptions, shown};

/// Identifies the one joint that moved in a record. `options` gives width and margin; its files are not read.
///
/// # Errors
///
/// [`EstimateError`]: the record is too short, or does not determine the joint's inertia.
pub fn identify_moving(
    joints: &[RecordedJoint],
    moved: usize,
    period_ns: u64,
    options: &IdentifyOptions,
) -> Result<IdentifiedJoint, EstimateError> {
    let name = || joints.get(moved).map_or_else(String::new, |joint| joint.name.clone());
    let mut enclosed = enclose_inertia(joints, period_ns, options.width)?;
    if moved >= enclosed.len() {
        let expected = enclosed.len();
        return Err(EstimateError::Length { joint: name(), found: 0, expected });
    }
    let undetermined = |why| EstimateError::Undetermined { joint: name(), why };
    let inertia = enclosed.swap_remove(moved).map_err(undetermined)?;
    let smoothed = Smoothed::new(joints, period_ns, options.width);
    let smoothed = smoothed.ok_or_else(|| EstimateError::Length {
        joint: name(),
        found: joints.first().map_or(0, |joint| joint.q.len()),
        expected: 0,
    })?;
    Ok(shown((joints, &smoothed), moved, inertia, options))
}
