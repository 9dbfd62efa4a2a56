//! Gains whose tube keeps the specification: designed, bounded, and designed again where the tube says no.

use std::path::Path;

use phihat_design::tube::{Desired, TubeRefusal, tube};
use phihat_design::{ArmBasis, Gains, JointRecord, Outcome, Settle, Tube};
use phihat_sim::Motion;
use phihat_study::{DesignMethod, Study};

use crate::error::SessionError;

/// How often gains are looked for.
const ROUNDS: u32 = 6;

/// How much further than the tube demands the specification of the next round goes.
const FURTHER: f64 = 0.95;

/// What is asked of the search at first: it reckons without the coupling that helps, and without what is known of
/// time, so that a tube uses some half of what it was asked for …
const FIRST: f64 = 1.4;

/// … and what is asked where it finds nothing although the tube may.
const EASIER: f64 = 1.8 / FIRST;

/// What is asked where a tube does not close: stiffer gains close it sooner.
const STIFFER: f64 = 1.0 / 3.0;

/// A tube that uses less of the specification than this leaves room for less torque noise …
const ENOUGH: f64 = 0.6;

/// … which is looked for once, by a specification at most so many times easier.
const EASIEST: f64 = 3.0;

/// One search.
type Make<'a> = &'a dyn Fn(&Study) -> Result<Outcome, SessionError>;

/// Designs for a study by `make`, until the tube of what was designed keeps the specification.
///
/// # Errors
///
/// [`SessionError`] of the search.
pub(crate) fn within_spec(
    study: &Study,
    path: &Path,
    make: Make<'_>,
) -> Result<Outcome, SessionError> {
    let motion = Motion::of(study);
    let motion = motion.map_err(|e| SessionError::at(path, e))?;
    let desired = Desired::of(study, |joint, t| motion.told(joint, t));
    let alone = || {
        let mut outcome = make(study)?;
        if let Outcome::Designed(gains) = &mut outcome
            && described(gains)
        {
            judge(study, gains, &desired);
        }
        Ok(outcome)
    };
    if study.design.method != DesignMethod::Ours {
        return alone();
    }
    let mut asked = study.clone();
    scale(&mut asked, |_| FIRST);
    let mut found = Found::default();
    for _ in 0..ROUNDS {
        let next = match make(&asked) {
            Ok(Outcome::Designed(gains)) if !described(&gains) => return alone(),
            Ok(Outcome::Designed(gains)) if found.seen(&gains) => found.again.take(),
            Ok(Outcome::Designed(mut gains)) => {
                let judged = judge(study, &mut gains, &desired);
                found.judged(gains, judged)
            }
            Ok(_) => found.refused(),
            // Gains are at hand: a search that cannot begin is no reason to have none.
            Err(_) if found.kept.is_some() => None,
            Err(why) => return Err(why),
        };
        let Some(factor) = next else { break };
        scale(&mut asked, |i| factor[i.min(factor.len() - 1)]);
    }
    if let Some(kept) = found.kept {
        return Ok(Outcome::Designed(kept));
    }
    let Some(closest) = found.closest.map(|(_, gains)| gains).or(found.open) else {
        return alone();
    };
    // What no search finds for the specification itself is infeasible, and says why.
    Ok(match make(study)? {
        Outcome::Designed(_) => Outcome::Designed(closest),
        Outcome::Infeasible(no) => Outcome::Infeasible(no),
    })
}

/// Whether the arm is known by its description, so that gains can have a tube; others keep the specification by
/// bounds of their own.
fn described(gains: &Gains) -> bool {
    gains.certificate.as_ref().is_some_and(|c| c.arm.basis == ArmBasis::Postures)
}

/// What the rounds have found so far.
#[derive(Default)]
struct Found {
    /// Laws whose tube was looked for.
    seen: Vec<Vec<JointRecord>>,
    /// Keeps the specification.
    kept: Option<Box<Gains>>,
    /// Its tube goes beyond the specification by the least factor.
    closest: Option<(f64, Box<Gains>)>,
    /// Its tube does not close.
    open: Option<Box<Gains>>,
    /// What is asked for where the next search finds the same law.
    again: Option<Vec<f64>>,
    /// A search was in vain, or a tube did not keep the specification: there is nothing to relax.
    hard: bool,
}

impl Found {
    /// Whether a law was looked at before.
    fn seen(&mut self, gains: &Gains) -> bool {
        let before = self.seen.contains(&gains.joints);
        self.seen.push(gains.joints.clone());
        before
    }

    /// A search was in vain; how much easier the next one has to be, if there is one.
    fn refused(&mut self) -> Option<Vec<f64>> {
        let first = self.seen.is_empty() && !self.hard;
        self.hard = true;
        first.then(|| vec![EASIER])
    }

    /// Takes gains with what their tube says; by which factor the next ones are asked for, per joint or for all, if
    /// it takes any.
    fn judged(&mut self, gains: Box<Gains>, judged: Judged) -> Option<Vec<f64>> {
        let relaxed = self.kept.is_some();
        // After the first try comes the specification itself.
        let (first, itself) = (self.seen.len() == 1 && !self.hard, vec![1.0 / FIRST]);
        match judged {
            Judged::Kept(used) => {
                self.kept = Some(gains);
                // The search was stricter than it had to be: less torque noise may do.
                let worth = used < ENOUGH && !relaxed && !self.hard;
                worth.then(|| vec![(1.0 / used).sqrt().min(EASIEST)])
            }
            _ if relaxed => None,
            Judged::Beyond(shares) => {
                self.hard = true;
                let worst = shares.iter().fold(0.0_f64, |m, share| m.max(*share));
                if self.closest.as_ref().is_none_or(|(least, _)| worst < *least) {
                    self.closest = Some((worst, gains));
                }
                let further = |share: &f64| if *share > 1.0 { FURTHER / share } else { 1.0 };
                let further: Vec<f64> = shares.iter().map(further).collect();
                self.again = Some(further.clone());
                Some(if first { itself } else { further })
            }
            Judged::Open => {
                self.hard = true;
                self.open = Some(gains);
                self.again = Some(vec![STIFFER]);
                Some(if first { itself } else { vec![STIFFER] })
            }
            Judged::Unknown => None,
        }
    }
}

/// What the tube of some gains says.
enum Judged {
    /// Largest share of the specification that is used.
    Kept(f64),
    /// Largest over allowed error of each joint.
    Beyond(Vec<f64>),
    /// Bounds grow without end.
    Open,
    /// There is no tube for another reason.
    Unknown,
}

/// Puts tube, settling time and what is not proved into the gains' certificate.
fn judge(study: &Study, gains: &mut Gains, desired: &Desired) -> Judged {
    let found = {
        let mut own = study.clone();
        match gains.complete(&mut own) {
            Ok(()) => tube(&own, gains, desired)
                .map_err(|why| (why.to_string(), matches!(why, TubeRefusal::Open { .. }))),
            Err(why) => Err((why.to_string(), false)),
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
        Err((why, open)) => {
            certificate.unproved.push(format!("the specification: no tube, {why}"));
            certificate.tube_refused = Some(why);
            certificate.settle = Some(Settle::of(study, None));
            return if open { Judged::Open } else { Judged::Unknown };
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
    clause(
        "spec.error_max_rad",
        spec.error_bound.as_ref(),
        &|i| tube.joints[i].error_max_rad,
        true,
    );
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
    for limits in [&mut study.spec.error_bound, &mut study.spec.velocity_error_max] {
        for (i, limit) in limits.iter_mut().flatten().enumerate() {
            *limit *= factor(i);
        }
    }
}
