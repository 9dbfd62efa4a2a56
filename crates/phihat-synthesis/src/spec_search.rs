//! Gains whose tube keeps the specification: designed, bounded, and designed again where the tube says no.

use phihat_certificate::extremes::Extremes as _;
use phihat_design::tube::{Desired, PARTS};
use phihat_design::{ArmBasis, Gains, Infeasible, JointRecord, Outcome};
use phihat_sim::Motion;
use phihat_study::{DesignMethod, Study};

use crate::error::SynthesisError;
use crate::judged::{ERROR_KEY, Judged, beyond_error, judge, missed};

/// Rounds of a search for gains, at most.
const ROUNDS: u32 = 6;

/// Factor by which the specification of the next round is stricter than the tube demands.
const FURTHER: f64 = 0.95;

/// Factor on the specification of the first search: it neglects the coupling that helps, and the knowledge of
/// time, so that a tube uses about half of the specification …
const FIRST: f64 = 1.4;

/// … and on that of the next one, where it finds nothing although the tube may.
const EASIER: f64 = 1.8 / FIRST;

/// Factor on the specification where a tube does not close: stiffer gains close it sooner.
const STIFFER: f64 = 1.0 / 3.0;

/// A tube that uses less of the specification than this leaves room for less torque noise …
const ENOUGH: f64 = 0.6;

/// … which is searched once, by a specification at most so many times easier.
const EASIEST: f64 = 3.0;

/// One search.
type SpecSearchMake<'a> = &'a dyn Fn(&Study) -> Result<Outcome, SynthesisError>;

/// Designs for a study by `make`, until the tube of what was designed keeps the specification.
///
/// # Errors
///
/// [`SynthesisError`] of the search.
pub(crate) fn within_spec(
    study: &Study,
    make: SpecSearchMake<'_>,
) -> Result<Outcome, SynthesisError> {
    let motion = Motion::of(study)?;
    let desired = Desired::of(study, |joint, t| motion.told(joint, t));
    let alone = || {
        let mut outcome = make(study)?;
        if let Outcome::Designed(gains) = &mut outcome
            && described(gains)
        {
            judge(study, gains, (&desired, PARTS));
        }
        Ok(outcome)
    };
    if study.design.method != DesignMethod::Ours {
        return alone();
    }
    let mut asked = study.clone();
    scale(&mut asked, |_| FIRST);
    let mut found = RoundResults::default();
    for _ in 0..ROUNDS {
        let next = match make(&asked) {
            Ok(Outcome::Designed(gains)) if !described(&gains) => return alone(),
            Ok(Outcome::Designed(gains)) if found.seen(&gains) => found.again.take(),
            Ok(Outcome::Designed(mut gains)) => {
                let judged = judge(study, &mut gains, (&desired, PARTS));
                found.judged(gains, judged)
            }
            Ok(_) => found.refused(),
            Err(SynthesisError::Cancelled) => return Err(SynthesisError::Cancelled),
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
    let closest = found.closest.map(|(_, gains)| gains).or(found.open);
    let own = if closest.is_some() { make(study)? } else { alone()? };
    // What no search finds for the specification itself is infeasible, and says why.
    Ok(match own {
        Outcome::Designed(own) => Outcome::Designed(closest.unwrap_or(own)),
        Outcome::Infeasible(no) => Outcome::Infeasible(kept_by_tube(no, study, &desired, make)?),
    })
}

/// With an error that the tube of gains keeps too: the search reckons with bounds of each joint alone.
fn kept_by_tube(
    mut no: Infeasible,
    study: &Study,
    desired: &Desired,
    make: SpecSearchMake<'_>,
) -> Result<Infeasible, SynthesisError> {
    let error = no.clauses.iter_mut().find(|clause| clause.key == ERROR_KEY);
    let Some(clause) = error.filter(|clause| clause.possible.is_some()) else { return Ok(no) };
    let mut eased = study.clone();
    let share = missed(clause);
    eased.spec.error_bound.iter_mut().flatten().for_each(|bound| *bound *= share);
    if let Outcome::Designed(mut gains) = make(&eased)?
        && described(&gains)
    {
        judge(&eased, &mut gains, (desired, PARTS));
        let beyond = beyond_error(&eased, &gains).into_iter().flatten().map(|own| missed(&own));
        let more = beyond.largest().max(1.0);
        clause.possible = clause.possible.map(|possible| possible * more);
    }
    Ok(no)
}

/// Returns true if the arm is known by its description, so that gains can have a tube; others satisfy the
/// specification by bounds of their own.
fn described(gains: &Gains) -> bool {
    gains.certificate.as_ref().is_some_and(|c| c.arm.basis == ArmBasis::Postures)
}

/// Results of the rounds so far.
#[derive(Default)]
struct RoundResults {
    /// Laws whose tube was looked for.
    seen: Vec<Vec<JointRecord>>,
    /// Keeps the specification.
    kept: Option<Box<Gains>>,
    /// Its tube goes beyond the specification by the least factor.
    closest: Option<(f64, Box<Gains>)>,
    /// Its tube does not close.
    open: Option<Box<Gains>>,
    /// Factors on the specification where the next search finds the same law.
    again: Option<Vec<f64>>,
    /// A search was in vain, or a tube did not keep the specification: there is nothing to relax.
    hard: bool,
}

impl RoundResults {
    /// Returns true if a law was tried before.
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
            Judged::Kept(shares) => {
                let used = shares.iter().copied().largest();
                self.kept = Some(gains);
                // The search was stricter than it had to be: less torque noise may do.
                let worth = used < ENOUGH && !relaxed && !self.hard;
                worth.then(|| vec![(1.0 / used).sqrt().min(EASIEST)])
            }
            _ if relaxed => None,
            Judged::Beyond(shares) => {
                self.hard = true;
                let worst = shares.iter().copied().largest();
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

fn scale(study: &mut Study, factor: impl Fn(usize) -> f64) {
    for limits in [&mut study.spec.error_bound, &mut study.spec.velocity_error_bound] {
        for (i, limit) in limits.iter_mut().flatten().enumerate() {
            *limit *= factor(i);
        }
    }
}
