//! Stability while the arm moves, in the certificate.

use super::arming::shared_law;
use crate::arm::{Arm, InertiaRates};
use crate::claims::Refutation;
use crate::claims::law::holds;
use crate::sampled::{FindMoving, Moving, refuse};
use crate::{Certificate, Gains};

const CLAIM: &str = "stability while moving";

/// Finds how fast the arm may move through its range of inertia, or says why that is not proved; for gains that were
/// chosen, since it takes as long as a search.
pub fn find_moving(gains: &mut Gains, arm: &Arm) {
    let Some(mut certificate) = gains.certificate.take() else { return };
    match of(&certificate, gains, arm) {
        Ok(moving) => certificate.moving = Some(moving),
        Err(why) => certificate.moving_refused = Some(why),
    }
    gains.certificate = Some(certificate);
}

fn of(certificate: &Certificate, gains: &Gains, arm: &Arm) -> Result<Moving, Refutation> {
    certificate.refused().map_or(Ok(()), Err)?;
    one_loop(certificate)?;
    shared_law(gains)?;
    let first = gains.joints.first().zip(certificate.joints.first());
    let (record, joint) = first.ok_or_else(|| refuse(CLAIM, "there is a joint", 0.0, 1.0))?;
    let range = (certificate.arm.low, certificate.arm.high);
    let found = Moving::find(record, &joint.model, range)?;
    let rates = arm.rates(&certificate.arm.nominal_kg_m2);
    let InertiaRates { motion_per_s, limits_per_s } = rates;
    Ok(Moving { needed_motion_per_s: motion_per_s, needed_limits_per_s: limits_per_s, ..found })
}

/// The multiplier is for joints that are all in the same loop.
fn one_loop(certificate: &Certificate) -> Result<(), Refutation> {
    let same = certificate.joints.windows(2).all(|pair| pair[0].model == pair[1].model);
    holds(CLAIM, "all joints are in the same loop", 0.0, 0.0, same)
}
