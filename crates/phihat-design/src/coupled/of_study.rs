//! Coupled gains of a study's arm.

use phihat_certificate::{CoupledGains, Gains, Refutation};
use phihat_study::{InertiaSource, Study};

use super::find::FindCoupledGains;
use super::postures::Postures;

/// Coupled gains of designed gains on a study's arm, over the postures handed over and those at which a push
/// does most. `None` where they carry no certificate, one that refuses a claim, or the arm is known by typed
/// or estimated intervals, which have no coupling.
///
/// # Errors
///
/// [`Refutation`] where the loop is not stable at one of the postures: then the range of inertia of the
/// search is too narrow.
pub fn coupled(
    study: &Study,
    gains: &Gains,
    along: &[Vec<f64>],
) -> Result<Option<CoupledGains>, Refutation> {
    let Some(certificate) = &gains.certificate else { return Ok(None) };
    let known = matches!(study.design.inertia, InertiaSource::Robot);
    // The payloads were attached when the arm's range was found.
    let (true, None, Ok(postures)) = (known, certificate.refused(), Postures::of(study)) else {
        return Ok(None);
    };
    let models = certificate.joints.iter().map(|joint| &joint.model);
    let loops: Vec<_> = gains.joints.iter().zip(models).collect();
    let range = (certificate.arm.low, certificate.arm.high);
    let worst = postures.worst(&loops, range, along);
    let source = format!(
        "frozen postures of {}: {} of the reference, and those found by a search for where a push does most, \
         empty-handed and with the payloads of the study; no claim about other postures, nor about motion",
        study.robot.name,
        along.len()
    );
    CoupledGains::find(&loops, &worst, source).map(Some)
}
