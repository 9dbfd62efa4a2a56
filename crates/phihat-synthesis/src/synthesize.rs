//! From a study to gains: the algorithm, from top to bottom.

use std::borrow::Cow;

use phihat::Form;
use phihat_certificate::extremes::Extremes as _;
use phihat_certificate::parallel::{both, threads};
use phihat_design::{
    Arm, Clause, Gains, Infeasible, Outcome, PhiOf, alternatives, find_moving, requested_gains,
};
use phihat_sim::{Demand, SimError, error_for_tip, overload};
use phihat_study::{DesignMethod, InertiaSource, PhiSource, Study};

use crate::along::coupled_along;
use crate::beyond::BeyondAnyLaw;
use crate::candidates::{candidates, with_phi};
use crate::class_search::for_class;
use crate::class_study::is_class;
use crate::coarser::coarser;
use crate::error::SynthesisError;
use crate::judged::{ERROR_KEY, Merit, beyond_error, missed};
use crate::position_search::by_positions;
use crate::recordings::Recordings;
use crate::rotor::smallest_rotor;
use crate::spec_search::within_spec;
use crate::springs::with_springs;
use crate::stated::certified;
use crate::steps::Steps;

/// Extent of the answer where no gains satisfy the specification.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Advice {
    /// Clauses that cannot be satisfied.
    #[default]
    Clauses,
    /// These, and the changes of the loop that would make it feasible: a search for each.
    Changes,
}

/// Options of a synthesis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SynthesisOptions {
    /// Extent of the answer where no gains satisfy the specification.
    pub advice: Advice,
    /// Accepts a motion that needs more than the drives have. If false, such a motion is an error.
    pub beyond_drives: bool,
}

/// Gains for a study, with their certificate, or the reason why there are none. Gains that a study states are never
/// replaced by others: they get their certificate.
///
/// # Method
///
/// ```text
/// specification     error bound of each joint; a bound on the tip becomes one of the joints
/// repeat
///     candidates    one law per joint from bounds of φ, within shares of the specification; no error bound yet
///     tube          envelope of the coupled arm's error along the motion, over all payloads and friction levels
///     shares        tube over specification, joint by joint: the share for the next candidates
/// certificate       window, margins, tube, coupled gains, stability while moving, coarser encoders
/// ```
///
/// Joints of an arm push each other, which the search for a candidate neglects: the only bound on the error of a
/// coupled arm is its tube, or, for a class of motions, the class bound, which judges candidates in the tube's place.
/// Where the arm is known by an interval of inertia per joint there is no coupling to count and no tube; each joint
/// then has a bound of its own.
///
/// # Errors
///
/// [`SynthesisError`]: the motion or the arm cannot be used. That no gains exist is an [`Outcome`].
///
/// # Example
///
/// See the crate's front page.
pub fn synthesize(
    study: &Study,
    arm: &Arm,
    recordings: &Recordings,
    options: SynthesisOptions,
) -> Result<Outcome, SynthesisError> {
    synthesize_in_steps(study, (arm, recordings), options, Steps::UNHEARD)
}

/// As [`synthesize`], with a listener to its steps.
///
/// # Errors
///
/// As of [`synthesize`]; [`SynthesisError::Cancelled`].
pub fn synthesize_in_steps(
    study: &Study,
    (arm, recordings): (&Arm, &Recordings),
    options: SynthesisOptions,
    steps: Steps<'_>,
) -> Result<Outcome, SynthesisError> {
    // Specification: a motion that the drives can follow, and an error bound for each joint.
    steps.begin("specification along the motion")?;
    if !options.beyond_drives
        && let Some(more) = overload(study)?
    {
        return Err(SynthesisError::Overload(Box::new(more)));
    }
    let specified = with_tip(study)?;

    // An error that no law keeps: the answer comes first, then a search says how little can be asked for.
    let searched =
        requested_gains(&specified).is_none() && specified.design.method == DesignMethod::Ours;
    let beyond = if searched { BeyondAnyLaw::of(&specified)? } else { None };
    if let Some(beyond) = &beyond {
        steps.begin(&beyond.step())?;
    }

    // A class of motions: candidates from the largest rates of the class, judged by the class bound.
    if is_class(study) {
        let mut outcome = for_class(&specified, arm, beyond, steps)?;
        if let Outcome::Designed(gains) = &mut outcome {
            complete_certificate(&specified, arm, gains, steps)?;
        }
        return Ok(outcome);
    }

    // Gains that the study states: no search, their certificate.
    if let Some(mut outcome) = certified(&specified, (arm, recordings))? {
        if let Outcome::Designed(gains) = &mut outcome {
            complete_certificate(&specified, arm, gains, steps)?;
        }
        return Ok(outcome);
    }

    // Candidates, tube, shares: repeated in the form of the law that is stated, or in both forms.
    let (formed, outcome) = if specified.control.form_designed {
        search_both_forms(&specified, (arm, recordings), options.advice, steps)?
    } else {
        (None, search_form(&specified, (arm, recordings), options.advice, steps)?)
    };
    if let Some(beyond) = beyond {
        return Ok(beyond.beside(&specified, outcome));
    }
    let study = formed.as_deref().unwrap_or(&specified);

    // Certificate: the claims that no search needs.
    match outcome {
        Outcome::Designed(mut gains) => {
            complete_certificate(study, arm, &mut gains, steps)?;
            Ok(Outcome::Designed(gains))
        }
        infeasible @ Outcome::Infeasible(_) => Ok(infeasible),
    }
}

/// The study with an error bound of its joints that keeps the bound on its tip, where it states one.
pub(crate) fn with_tip(study: &Study) -> Result<Cow<'_, Study>, SimError> {
    let Some(enough) = error_for_tip(study)? else { return Ok(Cow::Borrowed(study)) };
    let mut own = study.clone();
    let n = own.robot.joints.len();
    let bounds = own.spec.error_bound.get_or_insert_with(|| vec![f64::INFINITY; n]);
    for bound in bounds {
        *bound = bound.min(enough);
    }
    Ok(Cow::Owned(own))
}

/// Outcome of the search in the study's own form of the law.
fn search_form(
    study: &Study,
    (arm, recordings): (&Arm, &Recordings),
    advice: Advice,
    steps: Steps<'_>,
) -> Result<Outcome, SynthesisError> {
    let demand = Demand::along(study)?;
    // Arms that are known by intervals have no tube: the search by bounds serves them, whatever the law.
    if study.control.form == Form::Positions && study.design.inertia == InertiaSource::Robot {
        return by_positions(study, (arm, &demand), steps);
    }
    let within_shares = |own: &Study| {
        steps.begin("laws with a velocity, and their tube")?;
        candidates(own, arm, &demand, recordings)
    };
    match within_spec(study, &within_shares)? {
        Outcome::Infeasible(no)
            if advice == Advice::Changes && study.control.form != Form::Positions =>
        {
            let advised = advised(study, (arm, &demand), recordings, &no)?;
            Ok(Outcome::Infeasible(advised))
        }
        outcome => Ok(outcome),
    }
}

/// The changes of the loop after which there would be gains.
fn advised(
    study: &Study,
    (arm, demand): (&Arm, &Demand),
    recordings: &Recordings,
    no: &Infeasible,
) -> Result<Infeasible, SynthesisError> {
    let changes = |own: &Study, phi: PhiOf<'_>| {
        let alternatives = alternatives(own, arm, phi)?;
        Ok(Outcome::Infeasible(Infeasible { alternatives, ..no.clone() }))
    };
    let mut advised = match with_phi(study, demand, recordings, &changes)? {
        Outcome::Infeasible(advised) => advised,
        Outcome::Designed(_) => no.clone(),
    };
    // No law is stable over the range of inertia: a rotor makes an arm's inertia more nearly constant.
    if advised.stable == 0 && study.design.inertia == InertiaSource::Robot {
        advised.alternatives.extend(smallest_rotor(study)?);
    }
    Ok(advised)
}

/// Outcomes in both forms of the law that serve the study, and the better one, with the study in its form; by the
/// observer alone where no error is specified, a time is, or arm or `φ` are known by estimates.
fn search_both_forms(
    study: &Study,
    (arm, recordings): (&Arm, &Recordings),
    advice: Advice,
    steps: Steps<'_>,
) -> Result<(Option<Box<Study>>, Outcome), SynthesisError> {
    let formed = |form: Form| {
        let mut own = Box::new(study.clone());
        own.control.form_designed = false;
        own.control.takes(form);
        own
    };
    let observer = formed(Form::Observer);
    let search = |own: &Study, advice| search_form(own, (arm, recordings), advice, steps);
    if positions_serve(study) {
        let positions = formed(Form::Positions);
        if let Outcome::Designed(from_positions) = search(&positions, Advice::Clauses)? {
            return Ok(match search(&observer, Advice::Clauses)? {
                Outcome::Designed(observed)
                    if Merit::of(study, &observed).beats(Merit::of(study, &from_positions)) =>
                {
                    (Some(observer), Outcome::Designed(observed))
                }
                // Neither form keeps the specified error, and the tube gives the error that is possible.
                Outcome::Infeasible(mut no)
                    if let Some(beyond) = beyond_error(study, &from_positions) =>
                {
                    if advice == Advice::Changes
                        && let Outcome::Infeasible(advised) = search(&observer, advice)?
                    {
                        no = advised;
                    }
                    nearest_of(&mut no.clauses, beyond);
                    (Some(observer), Outcome::Infeasible(no))
                }
                _ => (Some(positions), Outcome::Designed(from_positions)),
            });
        }
    }
    let outcome = search(&observer, advice)?;
    Ok((Some(observer), outcome))
}

/// Returns true if a law from positions can serve the study: its claims rest on a tube.
fn positions_serve(study: &Study) -> bool {
    // How fast a step settles is a clause of the observer form's search alone.
    let timed = study.design.settling_time.is_some() || study.design.rise_time.is_some();
    let tube = study.design.inertia == InertiaSource::Robot
        && matches!(study.design.phi, PhiSource::Reference);
    study.design.method == DesignMethod::Ours
        && study.spec.error_bound.is_some()
        && !timed
        && tube
        && study.control.delay_samples <= phihat_study::AHEAD_MAX
}

/// The clauses of two searches, each for itself, that ask for less.
fn nearest_of(clauses: &mut Vec<Clause>, others: Vec<Clause>) {
    let error = clauses.iter().find(|clause| clause.key == ERROR_KEY).map_or(f64::INFINITY, missed);
    if others.iter().map(missed).largest() < error {
        *clauses = others;
    }
}

/// Adds to the certificate of the chosen gains what no search needs: the clause of elastic joints, coupled gains,
/// stability while the arm moves,
/// and the tubes behind coarser encoders.
fn complete_certificate(
    study: &Study,
    arm: &Arm,
    gains: &mut Gains,
    steps: Steps<'_>,
) -> Result<(), SynthesisError> {
    steps.begin("certificate: coupled gains, stability while moving, coarser encoders")?;
    with_springs(study, arm, gains)?;
    let mut moving = Box::new(gains.clone());
    // A search on one thread, beside work that is shared among all.
    let ((), found) = both(
        threads(),
        || find_moving(&mut moving, arm),
        || {
            coupled_along(study, gains).map_err(SynthesisError::from).and_then(|one| {
                // A search by tubes has computed these tubes with its own.
                if !gains.coarser.is_empty() {
                    return Ok((one, gains.coarser.clone()));
                }
                Ok((one, coarser(study, gains)?))
            })
        },
    );
    let (coupled, coarser) = found?;
    if let Some(certificate) = &mut moving.certificate {
        certificate.coupled = coupled;
    }
    moving.coarser = coarser;
    *gains = *moving;
    Ok(())
}
