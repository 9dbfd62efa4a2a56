//! The envelope as the certificate holds it: coarser bins, numbers rounded outward.

use phihat_certificate::extremes::{Extremes as _, hull};
use phihat_certificate::{Gains, Tube, TubeJoint, TubePayloadSet, outward};
use phihat_study::Study;

use super::desired::Desired;
use super::envelope::{Envelope, JointEnvelope};
use super::refusal::TubeRefusal;
use super::slices::{PARTS, find, find_behind, find_heaviest};
use super::tip::tip_along;
use crate::sampled::TorqueNoise;

/// Bins of the sweep in one bin of the document.
const COARSER: usize = 4;

/// Finds the [`Tube`] of a study under gains, as data.
///
/// # Errors
///
/// [`TubeRefusal`].
pub fn tube(study: &Study, gains: &Gains, desired: &Desired) -> Result<Tube, TubeRefusal> {
    tube_in_parts(study, gains, (desired, PARTS))
}

/// Finds the [`Tube`] as [`tube`] does, but with the payload in so many slices at least: the more, the
/// narrower the tube, and the longer it takes.
///
/// # Errors
///
/// [`TubeRefusal`].
pub fn tube_in_parts(
    study: &Study,
    gains: &Gains,
    (desired, parts): (&Desired, u32),
) -> Result<Tube, TubeRefusal> {
    let envelope = find(study, gains, (desired, parts))?;
    let bits = study.sensor.encoder_bits.as_deref();
    Ok(document(study, gains, desired, (bits, &envelope)))
}

/// The [`Tube`] over the heaviest of so many slices of the payload alone: for a search, between one
/// [`tube_in_parts`] and the next.
///
/// # Not claimed
///
/// Anything of other payloads: it is no tube of the study.
///
/// # Errors
///
/// [`TubeRefusal`].
pub fn tube_of_heaviest(
    study: &Study,
    gains: &Gains,
    (desired, parts): (&Desired, u32),
) -> Result<Tube, TubeRefusal> {
    let envelope = find_heaviest(study, gains, (desired, parts))?;
    let bits = study.sensor.encoder_bits.as_deref();
    Ok(document(study, gains, desired, (bits, &envelope)))
}

/// Finds the [`Tube`]s of a study under gains behind encoders of other resolutions \[bit\], in one pass, the
/// payload in so many slices at least.
///
/// # Errors
///
/// [`TubeRefusal`] of all; that of one resolution is in its place.
pub fn tubes_behind(
    study: &Study,
    gains: &Gains,
    (desired, parts): (&Desired, u32),
    encoders: &[Vec<u32>],
) -> Result<Vec<Result<Tube, TubeRefusal>>, TubeRefusal> {
    let all = find_behind(study, gains, (desired, parts), encoders)?;
    let one = |(bits, found): (&Vec<u32>, Result<Envelope, TubeRefusal>)| {
        Ok(document(study, gains, desired, (Some(bits), &found?)))
    };
    Ok(encoders.iter().zip(all).map(one).collect())
}

/// An envelope behind encoders of so many bits, as data.
fn document(
    study: &Study,
    gains: &Gains,
    desired: &Desired,
    (bits, envelope): (Option<&[u32]>, &Envelope),
) -> Tube {
    let quantum = |i: usize| bits.map_or(0.0, |bits| TorqueNoise::quantum(bits[i]));
    let joints = gains.joints.iter().zip(&envelope.joints);
    let joints = joints.map(|(record, own)| joint(&record.name, own)).collect();
    let mut tube = Tube {
        bin_s: envelope.bin_s * COARSER as f64,
        duration_s: study.duration,
        settle_s: study.spec.settle,
        slices: envelope.slices,
        payload: TubePayloadSet::from(&study.design.payload),
        coulomb_nm: study.design.coulomb.clone(),
        quantum_rad: (0..gains.joints.len()).map(quantum).collect(),
        joints,
        limits_silent: true,
        tip: None,
    };
    tube.tip = tip_along(study, desired, &tube);
    tube.steady_from(study.spec.settle)
}

fn joint(name: &str, own: &JointEnvelope) -> TubeJoint {
    let low = |values: &[(f64, f64)]| -> Vec<f64> {
        let bins = values.chunks(COARSER);
        bins.map(|bin| -outward(-hull(bin.iter().copied()).0)).collect()
    };
    let high = |values: &[(f64, f64)]| -> Vec<f64> {
        let bins = values.chunks(COARSER);
        bins.map(|bin| outward(hull(bin.iter().copied()).1)).collect()
    };
    let (error_low_rad, error_high_rad) = (low(&own.error), high(&own.error));
    let (velocity_low_rad_s, velocity_high_rad_s) = (low(&own.velocity), high(&own.velocity));
    let most = |values: &[f64]| outward(values.iter().copied().largest());
    TubeJoint {
        name: name.to_owned(),
        error_bound_rad: f64::INFINITY,
        velocity_error_bound_rad_s: f64::INFINITY,
        error_low_rad,
        error_high_rad,
        velocity_low_rad_s,
        velocity_high_rad_s,
        torque_max_nm: most(&own.torque),
        torque_step_nm: own.step.chunks(COARSER).map(most).collect(),
        torque_step_max_nm: f64::INFINITY,
        torque_step_steady_max_nm: f64::INFINITY,
    }
}
