//! The tube of gains along the motion of their study, derived a second time.

use phihat_certificate::tube::TubeReference;
use phihat_certificate::{Certificate, Refutation, TubeAgain};
use phihat_design::Gains;
use phihat_sim::{Motion, fed_along};
use phihat_study::Study;

/// The motion of a study for the second derivation of a tube, with the torque that is fed forward along it; `None`: the
/// study has no motion of its own.
pub fn tube_reference(gains: &Gains, study: &Study) -> Option<TubeReference> {
    let motion = Motion::of(study).ok()?;
    let n = study.robot.joints.len();
    let reference = TubeReference::of(study, |t| (0..n).map(|i| motion.told(i, t)).collect());
    let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let fed = fed_along(study, &motion, &inertia, reference.q.len()).ok()?;
    Some(reference.feeding(&fed))
}

/// The tube of gains for a study that they complete, derived again; `None`: they have none, or the study no motion.
pub(crate) fn derived_tube(
    (gains, certificate): (&Gains, &Certificate),
    study: &Study,
    share: &(dyn Fn(f64) + Sync),
) -> Result<Option<TubeAgain>, Refutation> {
    let Some(reference) = tube_reference(gains, study) else { return Ok(None) };
    certificate.derive_tube(gains, (study, &reference), share)
}
