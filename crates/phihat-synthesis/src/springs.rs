//! Joints that bend: the clause of chosen gains, or a slower law that bears the springs.

use phihat_design::elastic::{links_of, slower};
use phihat_design::prelude::*;
use phihat_design::tube::PARTS;
use phihat_design::{Arm, Certificate, ElasticJoints, Gains};
use phihat_study::Study;

use crate::along::arm_along;
use crate::class_study::is_class;
use crate::error::SynthesisError;
use crate::tube_of::bound_by_tube;

/// Factors by which laws are slowed.
const FACTORS: [f64; 12] = [1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0];

/// The clause of the specification that no gains have where joints bend.
const RIGID_ERROR: &str =
    "the error on joints that bend: bounds and tube are those of rigid joints";

/// Adds the clause of elastic joints to the certificate of gains, where the study states springs.
///
/// # Method
///
/// Where a search's law does not bear them, the first of some slower ones that does takes its place, with the tube of
/// rigid joints. Where none does, or the gains are stated, the certificate refuses them.
///
/// # Errors
///
/// [`SynthesisError`]: the arm's links are not known, or a claim cannot be computed.
pub(crate) fn with_springs(
    study: &Study,
    arm: &Arm,
    gains: &mut Gains,
) -> Result<(), SynthesisError> {
    let sound = gains.certificate.as_ref().is_some_and(|own| own.refused().is_none());
    if !sound || study.springs.stated().is_none() {
        return Ok(());
    }
    let own = completed(study, gains)?;
    let links = arm_along(&links_of(&own))?;
    let refusal = match ElasticJoints::find(&own, gains, &links) {
        Ok(clause) => {
            bear(gains, clause);
            return Ok(());
        }
        Err(refusal) => refusal,
    };
    let searched = study.gains.is_none() && !is_class(study);
    let slower = FACTORS.iter().filter(|_| searched).find_map(|factor| {
        let mut slow = slower(gains, *factor)?;
        let clause = ElasticJoints::find(&own, &slow, &links).ok()?;
        certify(&own, arm, &mut slow).ok()?;
        bear(&mut slow, clause);
        slow.method = format!("{}. The law itself is {refusal}", slow.method);
        Some(slow)
    });
    if let Some(slow) = slower {
        *gains = slow;
    } else if let Some(certificate) = &mut gains.certificate {
        certificate.unproved.push(refusal.to_string());
        certificate.elastic_refused = Some(Box::new(refusal.why));
    }
    Ok(())
}

fn completed(study: &Study, gains: &Gains) -> Result<Study, SynthesisError> {
    let mut own = study.clone();
    gains.complete(&mut own)?;
    Ok(own)
}

/// Puts a clause into the certificate of gains.
fn bear(gains: &mut Gains, clause: Option<ElasticJoints>) {
    if let Some(certificate) = &mut gains.certificate {
        certificate.elastic = clause.map(Box::new);
        certificate.unproved.push(RIGID_ERROR.to_owned());
    }
}

/// Gives gains the claims about their loop, and their tube.
fn certify(study: &Study, arm: &Arm, gains: &mut Gains) -> Result<(), SynthesisError> {
    let nominal = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    gains.certificate = Some(Certificate::find(study, gains, arm.against(nominal)?, &[])?);
    bound_by_tube(study, gains, PARTS)
}
