//! The tube of given gains along a study's motion.

use phihat_design::tube::{PARTS, TubeRefusal, tube_in_parts};
use phihat_design::{Gains, Tube};
use phihat_study::Study;

use crate::commanded::Commanded;
use crate::error::SynthesisError;
use crate::judged::judge;

/// Tube of gains along the motion of a study, over all its payloads and levels of dry friction; else the reason why
/// there is none.
///
/// # Errors
///
/// [`SynthesisError`]: the arm cannot follow its reference, or the gains do not fit the study.
pub fn tube_of(study: &Study, gains: &Gains) -> Result<Result<Tube, TubeRefusal>, SynthesisError> {
    let mut own = study.clone();
    gains.complete(&mut own)?;
    let desired = Commanded::of(&own)?.desired(gains)?;
    Ok(tube_in_parts(&own, gains, (&desired, PARTS)))
}

/// Bounds the errors of gains that carry a certificate by their tube, or states in the certificate why they have none;
/// the payload in so many slices at least ([`PARTS`]).
///
/// # Errors
///
/// As [`tube_of`].
///
/// # Example
///
/// A candidate of a search joint by joint has no bound on its error until its tube is found:
///
/// ```no_run
/// use phihat_design::tube::PARTS;
/// use phihat_design::{Outcome, search};
/// use phihat_synthesis::{arm_along, bound_by_tube, phi_along};
///
/// let study = phihat_study::Study::read("studies/first.toml".as_ref())?;
/// let demand = phihat_sim::Demand::along(&study)?;
/// let phi = |joint, inertia| phi_along(&demand, joint, inertia);
/// let Outcome::Designed(mut gains) = search(&study, &arm_along(&study)?, &phi)? else { return Ok(()) };
/// assert_eq!(gains.certificate.as_ref().and_then(|all| all.error_bound(0)), None);
/// bound_by_tube(&study, &mut gains, PARTS)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn bound_by_tube(study: &Study, gains: &mut Gains, slices: u32) -> Result<(), SynthesisError> {
    let mut own = study.clone();
    gains.complete(&mut own)?;
    let desired = Commanded::of(&own)?.desired(gains)?;
    judge(study, gains, (&desired, slices));
    Ok(())
}
