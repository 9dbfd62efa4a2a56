//! One joint of an arm that moved while the others were held.

use phihat_design::{EstimateError, RecordedJoint, Smoothed, estimate_inertia_of};

use super::{IdentifiedJoint, IdentifyOptions, shown};

/// Identifies the one joint that moved in a record. `options` gives width and margin; its files are not read.
///
/// # Errors
///
/// [`EstimateError`]: the record is too short, or the joint moved too little.
pub fn identify_moving(
    joints: &[RecordedJoint],
    moved: usize,
    period_ns: u64,
    options: &IdentifyOptions,
) -> Result<IdentifiedJoint, EstimateError> {
    let too_short = || {
        let joint = joints.get(moved).map_or_else(String::new, |joint| joint.name.clone());
        EstimateError::Excitation { joint, windows: 0 }
    };
    let smoothed = Smoothed::new(joints, period_ns, options.width).ok_or_else(too_short)?;
    let inertia = estimate_inertia_of(&smoothed.signals(), moved)?;
    Ok(shown(&smoothed, moved, inertia, options))
}
