//! Designed gains beside the limit of linear laws.

use phihat_design::sampled::TorqueNoise;
use phihat_design::{Gains, Phi, PhiBasis, beside_limit};
use phihat_sim::Demand;
use phihat_study::{PhiSource, Study};

use crate::along::phi_along;
use crate::error::SynthesisError;

/// Adds to gains, joint by joint, their distance from the bound that no linear law undercuts; see
/// [`beside_limit`]. Returns a warning for each joint without such a figure; `step` receives the current step.
///
/// `φ` is that of the certificate; where it says nothing of `φ`, what the study states, or that along the reference.
///
/// # Errors
///
/// [`SynthesisError`]: the study's arm cannot follow its reference, or the gains lack what the study leaves to them.
pub fn beside_limits(
    study: &Study,
    gains: &mut Gains,
    step: &mut dyn FnMut(&str),
) -> Result<Vec<String>, SynthesisError> {
    let mut study = study.clone();
    gains.complete(&mut study)?;
    let demand = Demand::along(&study)?;
    let Some(certificate) = &gains.certificate else { return Ok(Vec::new()) };
    let range = (certificate.arm.low, certificate.arm.high);
    let all = gains.joints.len();
    let (mut found, mut warnings) = (Vec::new(), Vec::new());
    for (i, (record, claims)) in gains.joints.iter().zip(&certificate.joints).enumerate() {
        step(&format!("limit of linear laws: joint {} of {all}", i + 1));
        let own = claims.phi.clone();
        let phi = own.unwrap_or_else(|| known(&study, &demand, (i, record.inertia_kg_m2)));
        let bits = study.sensor.encoder_bits.as_ref().and_then(|bits| bits.get(i));
        let quantum = bits.map_or(0.0, |bits| TorqueNoise::quantum(*bits));
        match beside_limit(record, &claims.model, (&phi, quantum), range) {
            Ok(limit) => found.push(limit),
            Err(why) => {
                warnings.push(format!("{}: no limit of linear laws: {why}", record.name));
            }
        }
    }
    gains.limit = found;
    Ok(warnings)
}

/// `φ` of a joint of an arm that is known by its description.
fn known(study: &Study, demand: &Demand, (joint, inertia): (usize, f64)) -> Phi {
    let along = phi_along(demand, joint, inertia);
    let PhiSource::Typed { rate, jump } = &study.design.phi else { return along };
    Phi {
        basis: PhiBasis::Typed,
        source: "typed in the study".to_owned(),
        rate_nm_s: rate[joint],
        jump_nm: jump[joint],
        ..along
    }
}
