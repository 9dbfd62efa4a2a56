//! Stability while the arm moves, in the certificate.

use crate::arm::{Arm, InertiaRates};
use crate::claims::Refutation;
use crate::sampled::{FindMoving, Moving};
use crate::{Certificate, Gains};

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
    let range = (certificate.arm.low, certificate.arm.high);
    let models = certificate.joints.iter().map(|joint| &joint.model);
    let found = Moving::find(&gains.joints.iter().zip(models).collect::<Vec<_>>(), range)?;
    let rates = arm.rates(&certificate.arm.nominal_kg_m2);
    let InertiaRates { motion_per_s, limits_per_s } = rates;
    Ok(Moving { needed_motion_per_s: motion_per_s, needed_limits_per_s: limits_per_s, ..found })
}
