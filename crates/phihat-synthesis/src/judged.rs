//! Comparison of the tube of gains with a specification.

use phihat_certificate::extremes::{Extremes as _, larger};
use phihat_design::tube::{Desired, TubeRefusal, tube_in_parts};
use phihat_design::{Clause, Gains, Settle, Tube, TubeJoint};
use phihat_study::Study;

/// Latest settling time where the study states none \[s\]: an error bound that holds only later is no claim.
pub const SETTLED_S: f64 = 3.0;

/// Result of the tube of some gains.
pub(crate) enum Judged {
    /// Largest over allowed error of each joint: all within.
    Kept(Vec<f64>),
    /// Largest over allowed error of each joint.
    Beyond(Vec<f64>),
    /// Bounds grow without end.
    Open,
    /// There is no tube for another reason.
    Unknown,
}

/// The study without limits of torque rate.
pub(crate) fn without_rate_limits(study: &Study) -> Box<Study> {
    let mut free = Box::new(study.clone());
    free.control.torque_rate_max = None;
    free.interface.profile.torque_rate_max = None;
    free
}

/// Puts tube, settling time and unproved clauses into the gains' certificate. Where that refuses a claim
/// there is no tube. The payload is in so many slices at least.
pub(crate) fn judge(study: &Study, gains: &mut Gains, (desired, parts): (&Desired, u32)) -> Judged {
    judge_by(study, gains, |own, gains| tube_in_parts(own, gains, (desired, parts)))
}

/// As [`judge`], by the tube that is found for the completed study.
pub(crate) fn judge_by(
    study: &Study,
    gains: &mut Gains,
    find: impl FnOnce(&Study, &Gains) -> Result<Tube, TubeRefusal>,
) -> Judged {
    let found = found(study, gains, find);
    let Some(certificate) = &mut gains.certificate else { return Judged::Unknown };
    let tube = match found {
        Ok(tube) => tube,
        Err((why, open)) => {
            certificate.unbounded(why, Settle::of(study, None));
            return if open { Judged::Open } else { Judged::Unknown };
        }
    };
    let mut unproved = Vec::new();
    let (judged, settle, tube) = judged(study, tube, &mut unproved);
    certificate.bound_by(tube, settle, unproved);
    judged
}

/// Result of a tube for gains that have no certificate, and the tube where one is found.
pub(crate) fn promised(
    study: &Study,
    gains: &Gains,
    find: impl FnOnce(&Study, &Gains) -> Result<Tube, TubeRefusal>,
) -> (Judged, Option<Tube>) {
    match found(study, gains, find) {
        Ok(tube) => {
            let (judged, _, tube) = judged(study, tube, &mut Vec::new());
            (judged, Some(tube))
        }
        Err((_, true)) => (Judged::Open, None),
        Err((_, false)) => (Judged::Unknown, None),
    }
}

/// Result of a tube, its settling time, and the tube from then on; clauses that it does not satisfy go to
/// `unproved`.
fn judged(study: &Study, tube: Tube, unproved: &mut Vec<String>) -> (Judged, Settle, Tube) {
    let settle = Settle::of(study, Some(&tube));
    let tube = tube.steady_from(settle.settle_s);
    let shares = shares(study, &tube, unproved);
    let used = shares.iter().copied().largest();
    let judged = if used <= 1.0 { Judged::Kept(shares) } else { Judged::Beyond(shares) };
    (judged, settle, tube)
}

/// The tube of gains for the completed study; else why there is none, and whether its bounds grow without end.
fn found(
    study: &Study,
    gains: &Gains,
    find: impl FnOnce(&Study, &Gains) -> Result<Tube, TubeRefusal>,
) -> Result<Tube, (String, bool)> {
    let refused = gains.certificate.as_ref().and_then(phihat_design::Certificate::refused);
    if let Some(why) = refused {
        return Err((format!("a claim does not hold: {why}"), true));
    }
    let mut own = study.clone();
    gains.complete(&mut own).map_err(|why| (why.to_string(), false))?;
    find(&own, gains).map_err(|why| (why.to_string(), matches!(why, TubeRefusal::Open { .. })))
}

/// Largest error of a tube's joint \[rad, m\] in the bins from a time \[s\] on.
pub fn late_error(bin_s: f64, joint: &TubeJoint, from_s: f64) -> f64 {
    let bins = joint.error_low_rad.iter().zip(&joint.error_high_rad).enumerate();
    let late = bins.filter(|(bin, _)| *bin as f64 * bin_s >= from_s);
    late.map(|(_, (low, high))| larger(low.abs(), high.abs())).largest()
}

/// The key of the error that joints are allowed.
pub(crate) const ERROR_KEY: &str = "spec.error_bound_rad";

/// The joints whose tube exceeds their allowed error, the worst first, each with the error of its tube;
/// `None` where there are none, no tube, or where another clause of the specification is not satisfied
/// either.
pub(crate) fn beyond_error(study: &Study, gains: &Gains) -> Option<Vec<Clause>> {
    let tube = gains.certificate.as_ref()?.tube.as_ref()?;
    let allowed = study.spec.error_bound.as_ref()?;
    let has: Vec<f64> = tube.joints.iter().map(|joint| joint.error_bound_rad).collect();
    let mut easier = study.clone();
    easier.spec.error_bound = Some(allowed.iter().zip(&has).map(|(a, b)| a.max(*b)).collect());
    let mut others = Vec::new();
    shares(&easier, tube, &mut others);
    let clause = |(joint, (wanted, has)): (&TubeJoint, (&f64, &f64))| Clause {
        key: ERROR_KEY.to_owned(),
        joint: Some(joint.name.clone()),
        wanted: *wanted,
        possible: Some(*has),
    };
    let joints = tube.joints.iter().zip(allowed.iter().zip(&has));
    let mut beyond: Vec<Clause> =
        joints.filter(|(_, (wanted, has))| has > wanted).map(clause).collect();
    beyond.sort_by(|a, b| missed(b).total_cmp(&missed(a)));
    (others.is_empty() && !beyond.is_empty()).then_some(beyond)
}

/// By how much the clause misses what it asks for; infinite where nothing is possible.
pub(crate) fn missed(clause: &Clause) -> f64 {
    clause.possible.map_or(f64::INFINITY, |possible| possible / clause.wanted)
}

/// Share of the specification that each joint's tube uses; clauses that it does not satisfy go to `unproved`.
pub(crate) fn shares(study: &Study, tube: &Tube, unproved: &mut Vec<String>) -> Vec<f64> {
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
    clause(ERROR_KEY, spec.error_bound.as_ref(), &|i| tube.joints[i].error_bound_rad, true);
    clause(
        "spec.velocity_error_bound_rad_s",
        spec.velocity_error_bound.as_ref(),
        &|i| tube.joints[i].velocity_error_bound_rad_s,
        true,
    );
    let steady = |i: usize| tube.joints[i].torque_step_steady_max_nm;
    clause("design.torque_step_max_nm", study.design.torque_step_max.as_ref(), &steady, false);
    let limits = spec.error_integral_bound.as_ref();
    clause("spec.error_integral_bound_rad_s", limits, &|i| tube.error_integral(i), false);
    if let Some(limit) = spec.tip_error_bound {
        let bound = tube.tip.as_ref().map_or(f64::INFINITY, |tip| tip.error_bound_m);
        if bound > limit {
            let (limit, bound) = (1e3 * limit, 1e3 * bound);
            unproved.push(format!("spec.tip_error_bound_mm = {limit}: the tube says {bound:.4e}"));
        }
        for share in &mut shares {
            *share = share.max(bound / limit);
        }
    }
    shares
}

/// Merit of gains by their certificate, to compare those of different forms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Merit {
    /// True if the tube satisfies every clause.
    kept: bool,
    /// The largest share of an error that is allowed; infinite without a tube.
    error: f64,
    /// The largest change of torque per sample, by what is allowed of it \[1\], or by 1 N·m.
    noise: f64,
}

impl Merit {
    pub(crate) fn of(study: &Study, gains: &Gains) -> Self {
        let none = Self { kept: false, error: f64::INFINITY, noise: f64::INFINITY };
        let Some(certificate) = &gains.certificate else { return none };
        let Some(tube) = &certificate.tube else { return none };
        let period = study.control.period_ns as f64 * 1e-9;
        let allowed = |i: usize| {
            let own = study.design.torque_step_max.as_ref().map(|most| most[i]);
            own.or(study.limits(i).1.map(|rate| rate * period)).unwrap_or(1.0)
        };
        let joints = || tube.joints.iter().enumerate();
        let noise = joints().map(|(i, joint)| joint.torque_step_steady_max_nm / allowed(i));
        let errors = shares(study, tube, &mut Vec::new());
        Self {
            kept: certificate.unproved.is_empty(),
            error: errors.into_iter().largest(),
            noise: noise.largest(),
        }
    }

    /// Returns true if these gains are the better ones: satisfied before not satisfied, then with less noise,
    /// or nearer to the specification.
    pub(crate) fn beats(self, other: Self) -> bool {
        match (self.kept, other.kept) {
            (true, true) => self.noise < other.noise,
            (own, theirs) if own != theirs => own,
            _ => self.error < other.error,
        }
    }
}
