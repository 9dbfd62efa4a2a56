//! One joint of an arm that moved while the others were held.

use phihat_design::{EstimateError, RecordedJoint, Smoothed, Undetermined, enclose_inertia_of};

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
    let inertia = enclose_inertia_of(joints, moved, period_ns, options.width)?;
    let short = || EstimateError::Undetermined {
        joint: joints[moved].name.clone(),
        why: Undetermined::Short,
    };
    let smoothed = Smoothed::new(joints, period_ns, options.width).ok_or_else(short)?;
    Ok(shown((joints, &smoothed), moved, inertia, options))
}
