//! Stability while the arm moves, in the certificate.

use crate::arm::{Arm, InertiaRates};
use crate::claims::Refutation;
use crate::sampled::{FindMoving, LoopModel, Moving};
use crate::{Certificate, Gains, JointRecord};
use phihat_certificate::AnySpeed;

/// Finds how fast the arm may move through its range of inertia, or says why that is not proved; for gains that were
/// chosen, since it takes as long as a search.
pub fn find_moving(gains: &mut Gains, arm: &Arm) {
    let Some(mut certificate) = gains.certificate.take() else { return };
    if certificate.frozen.is_some() && certificate.refused().is_none() {
        certificate.any_speed = any_speed(&loops(&certificate, gains), &certificate);
    }
    match of(&certificate, gains, arm) {
        Ok(moving) => certificate.moving = Some(moving),
        Err(why) => certificate.moving_refused = Some(why),
    }
    gains.certificate = Some(certificate);
}

fn of(certificate: &Certificate, gains: &Gains, arm: &Arm) -> Result<Moving, Refutation> {
    certificate.refused().map_or(Ok(()), Err)?;
    let range = (certificate.arm.low, certificate.arm.high);
    let found = Moving::find(&loops(certificate, gains), range)?;
    let rates = arm.rates(&certificate.arm.nominal_kg_m2);
    let InertiaRates { motion_per_s, limits_per_s } = rates;
    Ok(Moving { needed_motion_per_s: motion_per_s, needed_limits_per_s: limits_per_s, ..found })
}

fn loops<'a>(
    certificate: &'a Certificate,
    gains: &'a Gains,
) -> Vec<(&'a JointRecord, &'a LoopModel)> {
    gains.joints.iter().zip(certificate.joints.iter().map(|joint| &joint.model)).collect()
}

/// Halvings of the ratio's logarithm.
const HALVINGS: u32 = 12;

/// The widest range around the middle of the arm's range, at most that range, through which the inertia may
/// move at any speed; `None`: there is none.
fn any_speed(loops: &[(&JointRecord, &LoopModel)], certificate: &Certificate) -> Option<AnySpeed> {
    let (low, high) = (certificate.arm.low, certificate.arm.high);
    let middle = (low * high).sqrt();
    let proved = |wide: f64| {
        let share = libm::pow(high / low, 0.5 * wide);
        let range = AnySpeed { low: middle / share, high: middle * share };
        range.verify(loops).is_ok().then_some(range)
    };
    let whole = AnySpeed { low, high };
    if whole.verify(loops).is_ok() {
        return Some(whole);
    }
    let (mut narrow, mut wide, mut best) = (0.0, 1.0, None);
    for _ in 0..HALVINGS {
        let half = 0.5 * (narrow + wide);
        match proved(half) {
            Some(range) => (narrow, best) = (half, Some(range)),
            None => wide = half,
        }
    }
    best
}
