//! Designed gains whose tube keeps the specification by the second derivation too.

use phihat_certificate::extremes::larger;
use phihat_certificate::{Settle, TubeAgain};
use phihat_design::{Gains, Outcome, requested_gains};
use phihat_study::{DesignMethod, Study};
use phihat_synthesis::{Steps, SynthesisError};

use crate::second_tube::derived_tube;

/// Designs with a tighter specification, at most.
const ROUNDS: u32 = 2;

/// Limit that is left of one beyond which the second derivation goes, over the limit that would just do.
const ROOM: f64 = 0.98;

/// Largest factor by which a limit is tightened at once, where the ratio of both derivations is that of other figures.
const MOST: f64 = 1.5;

/// The outcome of a design whose tube is the wider of both derivations, so that `phihat verify` derives no wider one.
/// Where that goes beyond the specification, the search is repeated with tighter limits.
///
/// Where no such gains are found, the first ones stay, and their certificate lists the clauses as not proved.
///
/// # Errors
///
/// As of `again`, which designs for the given study.
pub(crate) fn confirmed(
    study: &Study,
    outcome: Outcome,
    steps: Steps<'_>,
    again: &dyn Fn(&Study) -> Result<Outcome, SynthesisError>,
) -> Result<Outcome, SynthesisError> {
    let Outcome::Designed(mut gains) = outcome else { return Ok(outcome) };
    let searched = study.design.method == DesignMethod::Ours && requested_gains(study).is_none();
    let Some(mut derived) = derived_for(&gains, study, steps)? else {
        return Ok(Outcome::Designed(gains));
    };
    let first = derived.clone();
    let mut harder = study.clone();
    for _ in 0..ROUNDS {
        if derived.unkept.is_empty() || !searched {
            break;
        }
        tighten(&mut harder, &derived);
        let Outcome::Designed(mut next) = again(&harder)? else { break };
        let kept = next.certificate.as_ref().is_some_and(|own| own.unproved.is_empty());
        let Some(own) = derived_for(&next, study, steps)?.filter(|_| kept) else { break };
        if own.unkept.is_empty() {
            widen(&mut next, study, own);
            return Ok(Outcome::Designed(next));
        }
        derived = own;
    }
    widen(&mut gains, study, first);
    Ok(Outcome::Designed(gains))
}

/// Puts the wider tube into the certificate of gains, with the clauses that it does not keep.
fn widen(gains: &mut Gains, study: &Study, derived: TubeAgain) {
    let Some(certificate) = &mut gains.certificate else { return };
    let mut unproved = core::mem::take(&mut certificate.unproved);
    unproved.extend(derived.unkept);
    match derived.wider {
        Some(tube) => {
            let settle = Settle::of(study, Some(&tube));
            certificate.bound_by(tube.steady_from(settle.settle_s), settle, unproved);
        }
        None => certificate.unproved = unproved,
    }
}

/// The tube of gains, derived again; `None`: they have none, or it cannot be.
fn derived_for(
    gains: &Gains,
    study: &Study,
    steps: Steps<'_>,
) -> Result<Option<TubeAgain>, SynthesisError> {
    let Some(certificate) = gains.certificate.as_ref().filter(|own| own.tube.is_some()) else {
        return Ok(None);
    };
    steps.begin("the tube, by the second derivation")?;
    let mut study = study.clone();
    if gains.complete(&mut study).is_err() {
        return Ok(None);
    }
    Ok(derived_tube((gains, certificate), &study, &|_| {}).ok().flatten())
}

/// Divides each limit that is not kept by the ratio of the second derivation to the first, joint by joint.
fn tighten(study: &mut Study, derived: &TubeAgain) {
    let of = |key: &str| derived.unkept.iter().any(|line| line.starts_with(key));
    let ratio =
        |(second, first): (f64, f64)| if first > 0.0 { larger(second / first, 1.0) } else { 1.0 };
    let by = |limits: &mut Option<Vec<f64>>, ratios: &dyn Fn(usize) -> f64| {
        for (i, limit) in limits.iter_mut().flatten().enumerate() {
            *limit *= ROOM / ratios(i);
        }
    };
    let joints = &derived.joints;
    let errors = |i: usize| ratio((joints[i].derived_error_bound_rad, joints[i].error_bound_rad));
    let velocities = |i: usize| {
        ratio((joints[i].derived_velocity_error_bound_rad_s, joints[i].velocity_error_bound_rad_s))
    };
    let others = |i: usize| larger(joints[i].tighter, 1.0).min(MOST);
    if of("spec.error_bound_rad") {
        by(&mut study.spec.error_bound, &errors);
    }
    if of("spec.velocity_error_bound_rad_s") {
        by(&mut study.spec.velocity_error_bound, &velocities);
    }
    if of("spec.error_integral_bound_rad_s") {
        by(&mut study.spec.error_integral_bound, &others);
    }
    if of("design.torque_step_max_nm") {
        by(&mut study.design.torque_step_max, &others);
    }
    if of("spec.tip_error_bound_mm") {
        let most = (0..joints.len()).map(errors).fold(1.0, larger);
        if let Some(limit) = &mut study.spec.tip_error_bound {
            *limit *= ROOM / most;
        }
    }
}
