//! The motion that the tube of gains is around: what the study's controller is told of it.

use phihat_design::Gains;
use phihat_design::tube::Desired;
use phihat_sim::{Motion, SimError, fed_along};
use phihat_study::Study;

/// The motion as gains are told of it, with what the study feeds forward: that goes by their `M̄`.
///
/// # Errors
///
/// [`SimError`]: the arm cannot follow the reference, or what is fed forward is no torque of an arm.
pub(crate) fn told(study: &Study, gains: &Gains) -> Result<Desired, SimError> {
    let motion = Motion::of(study)?;
    let bare = Desired::of(study, |joint, t| motion.told(joint, t));
    let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let samples = bare.q.len() / inertia.len().max(1);
    Ok(bare.feeding(&fed_along(study, &motion, &inertia, samples)?))
}
