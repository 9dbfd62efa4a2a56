//! Gains whose tube keeps the specification: designed, bounded, and designed again where the tube says no.

use std::path::Path;

use phihat_design::tube::{Desired, tube};
use phihat_design::{ArmBasis, Gains, Outcome, Settle, Tube};
use phihat_sim::Motion;
use phihat_study::{DesignMethod, Study};

use crate::failure::Failure;

/// How often gains are looked for.
const ROUNDS: u32 = 5;

/// How much further than the tube demands the specification of the next round goes.
const FURTHER: f64 = 0.95;

/// What is asked of the search where it finds nothing although the tube may: it reckons without the coupling that
/// helps, and without what is known of time.
const EASIER: f64 = 1.8;

/// A tube that uses less of the specification than this leaves room for less torque noise …
const ENOUGH: f64 = 0.8;

/// … which is looked for once, by a specification at most so many times easier.
const EASIEST: f64 = 3.0;

/// Designs for a study by `make`, until the tube of what was designed keeps the specification.
///
/// # Errors
///
/// [`Failure`] of the search.
#[allow(clippy::too_many_lines, reason = "one round after the other")]
pub(crate) fn tubed(
    study: &Study,
    path: &Path,
    make: &dyn Fn(&Study) -> Result<Outcome, Failure>,
) -> Result<Outcome, Failure> {
    let first = make(study)?;
    let described = |gains: &Gains| {
        gains.certificate.as_ref().is_some_and(|c| c.arm.basis == ArmBasis::Postures)
    };
    if let Outcome::Designed(gains) = &first
        && !described(gains)
    {
        return Ok(first);
    }
    let motion = Motion::new(&study.reference, &study.robot, study.duration);
    let motion = motion.map_err(|e| Failure::at(path, e))?;
    let desired = Desired::of(study, |joint, t| motion.at(joint, t));
    let ours = study.design.method == DesignMethod::Ours;
    let infeasible = matches!(first, Outcome::Infeasible(_)).then(|| first.clone());
    let mut asked = study.clone();
    let mut outcome = first;
    let mut best: Option<(f64, Box<Gains>)> = None;
    let mut kept: Option<Box<Gains>> = None;
    for round in 0..ROUNDS {
        let Outcome::Designed(mut gains) = outcome else {
            if round > 0 || !ours {
                break;
            }
            scale(&mut asked, |_| EASIER);
            outcome = make(&asked)?;
            continue;
        };
        let judged = judge(study, &mut gains, &desired);
        let shares = match judged {
            Judged::Beyond(shares) => shares,
            // The search was stricter than it had to be: less torque noise may do.
            Judged::Kept(used)
                if ours && used < ENOUGH && kept.is_none() && infeasible.is_none() =>
            {
                kept = Some(gains);
                scale(&mut asked, |_| (1.0 / used).sqrt().min(EASIEST));
                // Gains are at hand: a search that cannot begin is no reason to have none.
                match make(&asked) {
                    Ok(quieter) => outcome = quieter,
                    Err(_) => break,
                }
                continue;
            }
            Judged::Kept(_) => return Ok(Outcome::Designed(gains)),
            Judged::Unknown => {
                return Ok(match (kept, infeasible) {
                    (Some(gains), _) => Outcome::Designed(gains),
                    (None, Some(no)) => no,
                    (None, None) => Outcome::Designed(gains),
                });
            }
        };
        if let Some(gains) = kept {
            return Ok(Outcome::Designed(gains));
        }
        let worst = shares.iter().fold(0.0_f64, |m, share| m.max(*share));
        if best.as_ref().is_none_or(|(least, _)| worst < *least) {
            best = Some((worst, gains));
        }
        if !ours {
            break;
        }
        scale(&mut asked, |i| if shares[i] > 1.0 { FURTHER / shares[i] } else { 1.0 });
        outcome = make(&asked)?;
    }
    if let Some(gains) = kept {
        return Ok(Outcome::Designed(gains));
    }
    let closest = best.map(|(_, gains)| Outcome::Designed(gains));
    infeasible.or(closest).ok_or_else(|| Failure::plain("no gains were judged by their tube"))
}

/// What the tube of some gains says.
enum Judged {
    /// Largest share of the specification that is used.
    Kept(f64),
    /// Largest over allowed error of each joint.
    Beyond(Vec<f64>),
    /// There is no tube.
    Unknown,
}

/// Puts tube, settling time and what is not proved into the gains' certificate.
fn judge(study: &Study, gains: &mut Gains, desired: &Desired) -> Judged {
    let found = {
        let mut own = study.clone();
        match gains.give_filter(&mut own) {
            Ok(()) => tube(&own, gains, desired).map_err(|why| why.to_string()),
            Err(why) => Err(why.to_string()),
        }
    };
    let Some(certificate) = &mut gains.certificate else { return Judged::Unknown };
    // A bound by each joint's own φ is none for joints that push each other.
    for joint in &mut certificate.joints {
        joint.bounds = None;
        joint.phi = None;
    }
    certificate.unproved.clear();
    let tube = match found {
        Ok(tube) => tube,
        Err(why) => {
            certificate.unproved.push(format!("the specification: no tube, {why}"));
            certificate.tube_refused = Some(why);
            certificate.settle = Some(Settle::of(study, None));
            return Judged::Unknown;
        }
    };
    let settle = Settle::of(study, Some(&tube));
    let tube = tube.steady_from(settle.settle_s);
    let shares = shares(study, &tube, &mut certificate.unproved);
    certificate.settle = Some(settle);
    certificate.tube_refused = None;
    certificate.tube = Some(tube);
    let used = shares.iter().fold(0.0_f64, |m, share| m.max(*share));
    if used <= 1.0 { Judged::Kept(used) } else { Judged::Beyond(shares) }
}

/// What of the specification each joint's tube uses; clauses that it does not keep are told.
fn shares(study: &Study, tube: &Tube, unproved: &mut Vec<String>) -> Vec<f64> {
    let mut shares = vec![0.0_f64; tube.joints.len()];
    let spec = &study.spec;
    let mut clause =
        |key: &str, limits: Option<&Vec<f64>>, of: &dyn Fn(usize) -> f64, counts: bool| {
            for (i, limit) in limits.into_iter().flatten().enumerate() {
                let bound = of(i);
                if bound > *limit {
                    let name = &tube.joints[i].name;
                    unproved.push(format!("{key} = {limit} on {name}: the tube says {bound:.4e}"));
                }
                if counts {
                    shares[i] = shares[i].max(bound / limit);
                }
            }
        };
    clause("spec.error_max_rad", spec.error_max.as_ref(), &|i| tube.joints[i].error_max_rad, true);
    clause(
        "spec.velocity_error_max_rad_s",
        spec.velocity_error_max.as_ref(),
        &|i| tube.joints[i].velocity_error_max_rad_s,
        true,
    );
    let integral = |i: usize| {
        let joint = &tube.joints[i];
        let bins = joint.error_low_rad.iter().zip(&joint.error_high_rad);
        bins.map(|(low, high)| tube.bin_s * low.abs().max(high.abs())).sum()
    };
    let limits = spec.error_integral_max.as_ref();
    clause("spec.error_integral_max_rad_s", limits, &integral, false);
    shares
}

fn scale(study: &mut Study, factor: impl Fn(usize) -> f64) {
    for limits in [&mut study.spec.error_max, &mut study.spec.velocity_error_max] {
        for (i, limit) in limits.iter_mut().flatten().enumerate() {
            *limit *= factor(i);
        }
    }
}
