//! Tubes behind coarser encoders.

use phihat_design::tube::{TubeRefusal, tubes_behind};
use phihat_design::{CoarserEncoder, Gains, Tube};
use phihat_sim::SimError;
use phihat_study::Study;

use crate::commanded::Commanded;
use crate::judged::without_rate_limits;

/// Numbers of bits by which the encoders are coarser.
const FEWER: core::ops::RangeInclusive<u32> = 1..=3;

/// An encoder has one bit at least.
const BITS_MIN: u32 = 1;

/// The tubes of gains behind encoders of fewer bits, from where the tube settles on; none where the gains
/// have no tube, or no joint an encoder.
///
/// # Errors
///
/// [`SimError`]: the arm cannot follow the reference.
pub(crate) fn coarser(study: &Study, gains: &Gains) -> Result<Vec<CoarserEncoder>, SimError> {
    let settle = gains.certificate.as_ref().and_then(|certificate| {
        let parts = certificate.tube.as_ref()?.slices;
        Some((certificate.settle.as_ref()?.settle_s, parts))
    });
    let (Some((settle, parts)), Some(bits)) = (settle, &study.sensor.encoder_bits) else {
        return Ok(Vec::new());
    };
    let mut own = without_rate_limits(study);
    // Without a filter that the design chose there would have been no tube.
    if gains.complete(&mut own).is_err() {
        return Ok(Vec::new());
    }
    let desired = Commanded::of(&own)?.desired(gains)?;
    let encoders = encoders(bits);
    let tubes = tubes_behind(&own, gains, (&desired, parts), &encoders)
        .unwrap_or_else(|why| vec![Err(why); encoders.len()]);
    Ok(told_of(study, settle, tubes))
}

/// The encoders that are looked at, in place of one of so many bits.
pub(crate) fn encoders(bits: &[u32]) -> Vec<Vec<u32>> {
    let fewer = |by: u32| bits.iter().map(|bits| bits.saturating_sub(by).max(BITS_MIN)).collect();
    FEWER.map(fewer).collect()
}

/// Report of the tubes behind [`encoders`], from the settling time on.
pub(crate) fn told_of(
    study: &Study,
    settle: f64,
    tubes: Vec<Result<Tube, TubeRefusal>>,
) -> Vec<CoarserEncoder> {
    let period = study.control.period_ns as f64 * 1e-9;
    let one = |(bits_fewer, tube): (u32, Result<Tube, TubeRefusal>)| {
        let (tube, refused) = match tube {
            Ok(tube) => (Some(tube.steady_from(settle)), None),
            Err(why) => (None, Some(why.to_string())),
        };
        let joints = || tube.iter().flat_map(|tube| &tube.joints).enumerate();
        let limits = |i: usize| study.limits(i).1.map_or(f64::INFINITY, |rate| rate * period);
        CoarserEncoder {
            bits_fewer,
            error_bound_rad: joints().map(|(_, joint)| joint.error_bound_rad).collect(),
            torque_step_max_nm: joints().map(|(_, joint)| joint.torque_step_max_nm).collect(),
            within_rate_limits: tube.is_some()
                && joints().all(|(i, joint)| joint.torque_step_max_nm <= limits(i)),
            refused,
        }
    };
    FEWER.zip(tubes).map(one).collect()
}
