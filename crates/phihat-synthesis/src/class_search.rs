//! Gains for every motion of a class: searched by estimates, joint by joint, and judged by the class bound.

use phihat_certificate::extremes::Extremes as _;
use phihat_design::{
    Arm, ClassBound, ClassDemand, ClassRefusal, Clause, Gains, Infeasible, Outcome, Phi,
    PositionSearch, TubeParts, class_bound, class_parts, quick_class_bound, requested_gains,
};
use phihat_study::Study;

use crate::beyond::BeyondAnyLaw;
use crate::class_study::in_its_form;
use crate::error::SynthesisError;
use crate::judged::ERROR_KEY;
use crate::steps::Steps;

/// Rounds of the search, at most.
const ROUNDS: u32 = 7;

/// The same where no law keeps the specification, to say what can be asked for.
const FEW_ROUNDS: u32 = 2;

/// Factor on errors of a quick bound, which looks at fewer postures than the whole one.
const QUICK_IS_LOW: f64 = 1.2;

/// The encoder's share of the torque step that is allowed, first; and its ends.
const FIRST: f64 = 0.6;
const SHARES: (f64, f64) = (0.01, 1.0);

/// The error of a law falls by about this power of its noise, the torque step of a class by that.
const POWER: f64 = 0.4;
const STEP_POWER: f64 = 0.9;

/// Share of the allowed torque step that a search aims at.
const ROOM: f64 = 0.97;

/// Times that laws are made less noisy because the whole bound says more than the quick one.
const MENDED: u32 = 3;

/// A bound that uses less of the specification leaves room for less noise.
const ENOUGH: f64 = 0.9;

/// Largest relative change of a share at which the search has come to rest.
const STILL: f64 = 0.02;

/// Shares of what is allowed: error and torque step of each joint.
struct Shares {
    errors: Vec<f64>,
    steps: Vec<f64>,
}

impl Shares {
    fn of(study: &Study, class: &ClassBound) -> Self {
        let allowed = |i: usize| study.spec.error_bound.as_ref().map(|all| all[i]);
        let over = |(i, error): (usize, &f64)| allowed(i).map_or(0.0, |allowed| error / allowed);
        let period = study.control.period_ns as f64 * 1e-9;
        let step = |(i, step): (usize, &f64)| {
            let own = study.design.torque_step_max.as_ref().map(|most| most[i]);
            let rate = study.limits(i).1.map(|rate| rate * period);
            own.into_iter().chain(rate).map(|most| step / most).largest()
        };
        Self {
            errors: class.error_bound_rad.iter().enumerate().map(over).collect(),
            steps: class.torque_step_nm.iter().enumerate().map(step).collect(),
        }
    }

    /// The largest share of an error, and of a torque step.
    fn most(&self) -> (f64, f64) {
        (self.errors.iter().copied().largest(), self.steps.iter().copied().largest())
    }

    /// Rank, the smaller the better: torque steps within their limits, then errors, then less noise.
    fn rank(&self) -> (u8, f64) {
        match self.most() {
            (error, step) if error <= 1.0 && step <= 1.0 => (0, step),
            (error, step) if step <= 1.0 => (1, error),
            (_, step) => (2, step),
        }
    }

    /// Shares of the noise to try next.
    fn next(&self, shares: &[f64]) -> Vec<f64> {
        let (error, step) = self.most();
        let stiffer = libm::pow(1.03 * error, 1.0 / POWER);
        let factor = |i: usize| {
            let room = libm::pow(ROOM / self.steps[i].max(1e-3), 1.0 / STEP_POWER);
            if room < 1.0 {
                room
            } else if error > 1.0 {
                stiffer.min(room)
            } else if step <= 1.0 && error < ENOUGH {
                libm::pow(error / ENOUGH.sqrt(), 1.0 / POWER).max(0.3)
            } else {
                1.0
            }
        };
        let moved = shares.iter().enumerate();
        moved.map(|(i, share)| (share * factor(i)).clamp(SHARES.0, SHARES.1)).collect()
    }
}

/// The best laws so far.
struct BestOfClass {
    rank: (u8, f64),
    shares: Vec<f64>,
    /// Errors by the quick bound of such laws within the torque step \[rad\].
    errors: Vec<f64>,
    /// Parts of their quick bounds by cause.
    parts: Vec<TubeParts>,
    gains: Box<Gains>,
}

/// Gains for a study's class: those that it states, else those that are searched for; with the class bound in their
/// certificate. A class of which no law keeps a clause has a short search for what can be asked for.
///
/// # Errors
///
/// [`SynthesisError`] of the search.
pub(crate) fn for_class(
    study: &Study,
    arm: &Arm,
    beyond: Option<BeyondAnyLaw>,
    steps: Steps<'_>,
) -> Result<Outcome, SynthesisError> {
    let study = &*in_its_form(study);
    steps.begin("largest rates of the class")?;
    let demand = ClassDemand::of(study)?;
    let phi = |joint: usize, _: f64| -> Phi { demand.phi(joint) };
    steps.begin("nominal inertias")?;
    let mut search = PositionSearch::new(study, arm, &phi)?;
    let certified = |mut gains: Box<Gains>, search: &PositionSearch<'_>, bound| {
        steps.begin("certificate of the laws, and the class bound")?;
        search.certify(&mut gains)?;
        judge(study, &mut gains, bound);
        Ok(Outcome::Designed(gains))
    };
    if let Some(stated) = requested_gains(study) {
        return certified(Box::new(stated), &search, None);
    }
    let rounds = if beyond.is_none() { ROUNDS } else { FEW_ROUNDS };
    let first = vec![FIRST; study.robot.joints.len()];
    let (best, radius) = searched(study, &mut search, (&first, rounds), steps)?;
    if let Some(beyond) = beyond {
        return Ok(Outcome::Infeasible(impossible(study, beyond, best.as_ref())));
    }
    let best = best.map(|plain| weighed(study, &mut search, plain, steps)).transpose()?;
    match best {
        Some(best) => {
            let (gains, bound) = within_step(study, &mut search, best, steps)?;
            certified(gains, &search, bound)
        }
        None => Ok(Outcome::Infeasible(radius.map_or_else(|| search.refused(), open))),
    }
}

/// The same laws where they keep the specification by the quick bound; else the better of them and those of a second
/// search, whose estimates agree with the class bound of the first: a share is then one of all causes of a torque step.
/// Where the study allows it, these laws filter their innovation.
fn weighed(
    study: &Study,
    search: &mut PositionSearch<'_>,
    plain: BestOfClass,
    steps: Steps<'_>,
) -> Result<BestOfClass, SynthesisError> {
    if plain.rank.0 == 0 {
        return Ok(plain);
    }
    search.weigh(&plain.gains, &plain.parts);
    search.filter_as_stated(study);
    let first = vec![ROOM; plain.shares.len()];
    let (found, _) = searched(study, search, (&first, ROUNDS), steps)?;
    Ok(found.filter(|own| own.rank < plain.rank).unwrap_or(plain))
}

/// The outcome where no law keeps some clauses, with the error that the best laws of a short search reach.
fn impossible(study: &Study, beyond: BeyondAnyLaw, best: Option<&BestOfClass>) -> Infeasible {
    let possible = |name: &str| {
        let mut joints = study.robot.joints.iter().zip(&best?.errors);
        joints.find(|(joint, _)| joint.name == name).map(|(_, error)| QUICK_IS_LOW * error)
    };
    let words = best.map(|best| {
        let least = QUICK_IS_LOW * best.errors.iter().copied().largest();
        format!(
            "the least that can be asked for on every joint is about {ERROR_KEY} = {least:.2e}: what laws within the \
             torque step reach, by a quick bound"
        )
    });
    beyond.with_possible(possible, words)
}

/// The best laws of so many rounds at most, and the last spectral radius at which the class did not close.
fn searched(
    study: &Study,
    search: &mut PositionSearch<'_>,
    (first, rounds): (&[f64], u32),
    steps: Steps<'_>,
) -> Result<(Option<BestOfClass>, Option<f64>), SynthesisError> {
    let mut shares = first.to_vec();
    let mut best: Option<BestOfClass> = None;
    let mut radius = None;
    for round in 1..=rounds {
        steps.begin(&format!("laws for the class, and their bound: round {round}"))?;
        let Some((gains, _)) = search.laws(&shares) else { break };
        let next: Vec<f64> = match quick_class_bound(study, &gains) {
            Ok(class) => {
                let found = Shares::of(study, &class);
                let rank = found.rank();
                let gained = best.as_ref().is_none_or(|before| rank < before.rank);
                let done = best.as_ref().is_some_and(|before| before.rank.0 == 0) && !gained;
                if gained {
                    let (shares, parts) = (shares.clone(), class_parts(&class));
                    // Torque steps beyond their limits have to come back.
                    let back = libm::pow(found.most().1.max(1.0), POWER / STEP_POWER);
                    let errors = class.error_bound_rad.iter().map(|error| back * error).collect();
                    best =
                        Some(BestOfClass { rank, shares, errors, parts, gains: Box::new(gains) });
                }
                if done {
                    break;
                }
                found.next(&shares)
            }
            // Stiffer laws close a class sooner.
            Err(ClassRefusal::Open { radius: own, .. }) => {
                radius = Some(own);
                shares.iter().map(|share| (1.4 * share).min(SHARES.1)).collect()
            }
            Err(ClassRefusal::Unstable(_)) => {
                shares.iter().map(|share| (0.7 * share).max(SHARES.0)).collect()
            }
            Err(why) => return Err(why.into()),
        };
        let moved = next.iter().zip(&shares).any(|(a, b)| (a / b - 1.0).abs() > STILL);
        if !moved {
            break;
        }
        shares = next;
    }
    Ok((best, radius))
}

/// Laws whose torque steps keep their limits by the whole bound, which looks at more postures than the search did; and
/// that bound, where it was computed for these laws.
fn within_step(
    study: &Study,
    search: &mut PositionSearch<'_>,
    BestOfClass { mut shares, mut gains, .. }: BestOfClass,
    steps: Steps<'_>,
) -> Result<(Box<Gains>, Option<ClassBound>), SynthesisError> {
    for _ in 0..MENDED {
        steps.begin("the whole bound of the best laws")?;
        let Ok(class) = class_bound(study, &gains) else { break };
        let found = Shares::of(study, &class);
        if found.most().1 <= 1.0 {
            return Ok((gains, Some(class)));
        }
        for (share, step) in shares.iter_mut().zip(&found.steps) {
            *share *= libm::pow(ROOM / step.max(ROOM), 1.0 / STEP_POWER);
        }
        let Some((quieter, _)) = search.laws(&shares) else { break };
        gains = Box::new(quieter);
    }
    Ok((gains, None))
}

/// No law that was tried closes the class.
fn open(radius: f64) -> Infeasible {
    let clause = Clause {
        key: "spectral radius of the class".to_owned(),
        joint: None,
        wanted: 1.0,
        possible: Some(radius),
    };
    let words = vec!["the class is too fast: an error adds more to itself than it is".to_owned()];
    Infeasible { clauses: vec![clause], words, ..Infeasible::default() }
}

/// Puts the class bound, computed unless it is given, and the clauses that it does not keep into a certificate.
fn judge(study: &Study, gains: &mut Gains, bound: Option<ClassBound>) {
    let refused = gains.certificate.as_ref().and_then(phihat_design::Certificate::refused);
    let found = match refused {
        Some(why) => Err(format!("a claim does not hold: {why}")),
        None => bound.map_or_else(|| class_bound(study, gains), Ok).map_err(|why| why.to_string()),
    };
    let Some(certificate) = &mut gains.certificate else { return };
    for joint in &mut certificate.joints {
        // Of the search alone.
        joint.phi = None;
    }
    certificate.unproved.clear();
    let class = match found {
        Ok(class) => class,
        Err(why) => {
            certificate.unproved.push(format!("the specification: no class bound, {why}"));
            certificate.class_refused = Some(why);
            return;
        }
    };
    let acts = limit_that_acts(study, &class);
    let shares = Shares::of(study, &class);
    for (i, joint) in study.robot.joints.iter().enumerate() {
        let allowed = study.spec.error_bound.as_ref().map(|all| all[i]);
        if let Some(allowed) = allowed.filter(|_| shares.errors[i] > 1.0) {
            let bound = class.error_bound_rad[i];
            let line = format!(
                "{ERROR_KEY} = {allowed} on {}: the class bound says {bound:.4e}",
                joint.name
            );
            certificate.unproved.push(line);
        }
        let most = study.design.torque_step_max.as_ref().map(|most| most[i]);
        if let Some(most) = most.filter(|most| class.torque_step_nm[i] > *most) {
            let (key, step) = ("design.torque_step_max_nm", class.torque_step_nm[i]);
            let line = format!("{key} = {most} on {}: the class bound says {step:.4e}", joint.name);
            certificate.unproved.push(line);
        }
    }
    if let Some(why) = acts {
        certificate.unproved.push(format!("the specification: no class bound, {why}"));
        certificate.class_refused = Some(why);
        return;
    }
    certificate.class = Some(Box::new(class));
}

/// The limit that could act somewhere in the class: the bound holds where none does.
fn limit_that_acts(study: &Study, class: &ClassBound) -> Option<String> {
    let period = study.control.period_ns as f64 * 1e-9;
    study.robot.joints.iter().enumerate().find_map(|(i, joint)| {
        let (torque, rate) = study.limits(i);
        let (own, step) = (class.torque_nm[i], class.torque_step_nm[i]);
        let beyond = |what: &str, own: f64, limit: f64| {
            format!("{what} of {} may reach its limit: {own:.4} N·m of {limit:.4}", joint.name)
        };
        let torque = torque.filter(|limit| own > *limit);
        let rate = rate.map(|rate| rate * period).filter(|limit| step > *limit);
        torque
            .map(|limit| beyond("the torque", own, limit))
            .or_else(|| rate.map(|limit| beyond("the torque step", step, limit)))
    })
}
