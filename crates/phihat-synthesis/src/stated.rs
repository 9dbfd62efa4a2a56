//! Certificate of the gains that a study states.

use phihat_design::prelude::*;
use phihat_design::tube::PARTS;
use phihat_design::{
    Arm, ArmBasis, Certificate, DesignError, Gains, Outcome, PhiOf, requested_gains,
};
use phihat_sim::Demand;
use phihat_study::{DesignMethod, Study};

use crate::candidates::with_phi;
use crate::error::SynthesisError;
use crate::recordings::Recordings;
use crate::tube_of::bound_by_tube;

/// The gains that a study states with their certificate: claims about the loop, and of an arm with a description the
/// tube, or the reason why there is none. Clauses of the specification that they do not satisfy are listed as not
/// proved. `None`: the study leaves its gains to a search or to the paper's recipe.
///
/// # Errors
///
/// [`SynthesisError`]: the arm or its motion cannot be used, or a claim cannot be computed.
pub(crate) fn certified(
    study: &Study,
    (arm, recordings): (&Arm, &Recordings),
) -> Result<Option<Outcome>, SynthesisError> {
    let ours = study.design.method == DesignMethod::Ours;
    let Some(stated) = requested_gains(study).filter(|_| ours) else { return Ok(None) };
    let demand = Demand::along(study)?;
    let with_claims = |study: &Study, phi: PhiOf<'_>| with_claims(study, arm, (&stated, phi));
    let mut outcome =
        with_phi(study, &demand, recordings, &|study, phi| Ok(with_claims(study, phi)?))?;
    if let Outcome::Designed(gains) = &mut outcome
        && gains.certificate.as_ref().is_some_and(|own| own.arm.basis == ArmBasis::Postures)
    {
        bound_by_tube(study, gains, PARTS)?;
    }
    Ok(Some(outcome))
}

/// Gains with every claim about their loop.
fn with_claims(
    study: &Study,
    arm: &Arm,
    (stated, phi): (&Gains, PhiOf<'_>),
) -> Result<Outcome, DesignError> {
    let mut gains = stated.clone();
    let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let known: Vec<_> = inertia.iter().enumerate().map(|(i, own)| Some(phi(i, *own))).collect();
    gains.certificate = Some(Certificate::find(study, &gains, arm.against(inertia)?, &known)?);
    Ok(Outcome::Designed(Box::new(gains)))
}
