//! Data of arm and φ, from the sources that a study names: plain data goes to the design.

use std::borrow::Cow;
use std::path::Path;

use crate::along::{arm_along, coupled_along, motion_along, phi_along};
use crate::coarser::coarser;
use crate::judged::{ERROR_KEY, Merit, beyond_error, missed};
use crate::position_search::by_positions;
use crate::typed_phi::typed_phi_holds;
use phihat::Form;
use phihat_certificate::extremes::Extremes as _;
use phihat_design::{
    Arm, Clause, Gains, Infeasible, JointSignals, Outcome, Phi, PhiBasis, alternatives,
    estimate_inertia, find_moving, search, typed_inertia_holds,
};
use phihat_sim::{
    Demand, Observed, PhiAlong, SimError, Simulation, Trace, error_for_tip, overload,
};
use phihat_study::{DesignMethod, InertiaSource, PhiSource, Study};

use crate::error::SessionError;
use crate::files;
use crate::origin::trace_at;
use crate::rotor::smallest_rotor;

/// Reads a study.
///
/// # Errors
///
/// [`SessionError::Study`]
pub fn read(path: &Path) -> Result<Box<Study>, SessionError> {
    let mut study = Study::read(path).map(Box::new)?;
    phihat_sim::derive_substeps(&mut study);
    Ok(study)
}

/// Number of times that the allowed error is doubled to find gains for a first simulation.
const DOUBLINGS: u32 = 12;

/// The arm, from whatever the study knows it by: description, typed inertia, or a recorded trace.
///
/// # Errors
///
/// [`SessionError`]: what it is known by cannot be used, or contradicts the description.
pub fn arm(study: &Study, path: &Path) -> Result<Arm, SessionError> {
    typed_inertia_holds(study).map_err(|e| SessionError::at(path, e))?;
    let InertiaSource::Trace(file) = &study.design.inertia else {
        return arm_along(study).map_err(|e| SessionError::at(path, e));
    };
    let trace = recorded(study, file)?;
    let signals = trace.joints.iter().map(|joint| JointSignals {
        name: &joint.name,
        q: &joint.q,
        dq: &joint.dq,
        ddq: &joint.ddq,
        tau: &joint.tau_applied,
    });
    let signals: Vec<_> = signals.collect();
    let estimates = estimate_inertia(&signals, trace.period_ns);
    estimates.map(|found| Arm::estimated(&found)).map_err(|e| SessionError::at(file, e))
}

/// Advice on a specification that cannot be satisfied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Advice {
    /// Clauses that cannot be satisfied.
    Clauses,
    /// These, and the changes of the loop that would make it feasible: a search for each.
    Changes,
}

/// Designs gains for a study, from what it knows of its arm and of `φ`; without changes of the loop that would help.
///
/// # Errors
///
/// [`SessionError`]: the design cannot begin. That no gains exist is an [`Outcome`].
pub fn designed(study: &Study, path: &Path) -> Result<Outcome, SessionError> {
    designed_for(study, &arm(study, path)?, path, Advice::Clauses)
}

/// Designs gains for a study and its arm, with `φ` from the source the study names.
///
/// # Errors
///
/// As [`designed`]; its motion needs more than the drives have.
pub fn designed_for(
    study: &Study,
    arm: &Arm,
    path: &Path,
    advice: Advice,
) -> Result<Outcome, SessionError> {
    match overload(study).map_err(|e| SessionError::at(path, e))? {
        Some(more) => Err(SessionError::at(path, more)),
        None => found_for(study, arm, path, advice),
    }
}

/// As [`designed_for`], of a motion that the drives are known to bear or that shall go beyond them.
pub(crate) fn found_for(
    study: &Study,
    arm: &Arm,
    path: &Path,
    advice: Advice,
) -> Result<Outcome, SessionError> {
    let for_tip = with_tip(study).map_err(|e| SessionError::at(path, e))?;
    if for_tip.control.form_designed {
        let (formed, outcome) = either_form(&for_tip, arm, path, advice)?;
        return completed(&formed, arm, outcome, path);
    }
    let outcome = sought(&for_tip, arm, path, advice)?;
    completed(&for_tip, arm, outcome, path)
}

/// Outcome of the search in the study's own form.
fn sought(study: &Study, arm: &Arm, path: &Path, advice: Advice) -> Result<Outcome, SessionError> {
    let demand = Demand::along(study).map_err(|e| SessionError::at(path, e))?;
    let moving = |phi: &dyn Fn(usize, f64) -> Phi, joint: usize, inertia: f64| {
        let motion = Some(motion_along(&demand, joint));
        Phi { motion, ..phi(joint, inertia) }
    };
    let made = |study: &Study, phi: &dyn Fn(usize, f64) -> Phi| {
        let phi = |joint, inertia| moving(phi, joint, inertia);
        search(study, arm, &phi).map_err(|e| SessionError::at(path, e))
    };
    // Arms that are known by intervals have no tube: the search by bounds serves them, whatever the law.
    if study.control.form == Form::Positions && study.design.inertia == InertiaSource::Robot {
        return by_positions(study, (arm, &demand), path);
    }
    let make = |asked: &Study| estimated(asked, path, &demand, &made);
    let mut outcome = crate::spec_search::within_spec(study, path, &make)?;
    if let Outcome::Infeasible(no) = &mut outcome
        && advice == Advice::Changes
        && study.control.form != Form::Positions
    {
        let advised = |study: &Study, phi: &dyn Fn(usize, f64) -> Phi| {
            let phi = |joint, inertia| moving(phi, joint, inertia);
            let alternatives =
                alternatives(study, arm, &phi).map_err(|e| SessionError::at(path, e))?;
            Ok(Outcome::Infeasible(Infeasible { alternatives, ..no.clone() }))
        };
        if let Outcome::Infeasible(told) = estimated(study, path, &demand, &advised)? {
            *no = told;
        }
        // Nothing keeps the window: a rotor makes an arm's inertia more nearly constant.
        if no.stable == 0 && study.design.inertia == InertiaSource::Robot {
            no.alternatives.extend(smallest_rotor(study, path)?);
        }
    }
    Ok(outcome)
}

/// The study with an error of its joints that keeps the bound on its tip, where it states one.
pub(crate) fn with_tip(study: &Study) -> Result<Cow<'_, Study>, SimError> {
    let Some(enough) = error_for_tip(study)? else { return Ok(Cow::Borrowed(study)) };
    let mut own = study.clone();
    let n = own.robot.joints.len();
    let asked = own.spec.error_bound.get_or_insert_with(|| vec![f64::INFINITY; n]);
    for bound in asked {
        *bound = bound.min(enough);
    }
    Ok(Cow::Owned(own))
}

/// Designs in both forms that serve the study, and takes the better one, with the study in its form; by the
/// observer alone where no error is specified, a time is, or arm or `φ` are known by estimates.
fn either_form(
    study: &Study,
    arm: &Arm,
    path: &Path,
    advice: Advice,
) -> Result<(Box<Study>, Outcome), SessionError> {
    let formed = |form: Form| {
        let mut own = Box::new(study.clone());
        own.control.form_designed = false;
        own.control.takes(form);
        own
    };
    let observer = formed(Form::Observer);
    let ours = study.design.method == DesignMethod::Ours;
    // How fast a step settles is a clause of the observer form's search alone.
    let timed = study.design.settling_time.is_some() || study.design.rise_time.is_some();
    let asked = study.spec.error_bound.is_some() && !timed;
    // What a tube is reckoned from: laws from positions have no claim without one.
    let known = study.design.inertia == InertiaSource::Robot
        && matches!(study.design.phi, PhiSource::Reference);
    let ahead = study.control.delay_samples <= phihat_study::AHEAD_MAX;
    if ours && asked && known && ahead {
        let positions = formed(Form::Positions);
        if let Outcome::Designed(seen) = sought(&positions, arm, path, Advice::Clauses)? {
            return Ok(match sought(&observer, arm, path, Advice::Clauses)? {
                Outcome::Designed(fed) if Merit::of(study, &fed).beats(Merit::of(study, &seen)) => {
                    (observer, Outcome::Designed(fed))
                }
                // Neither keeps the error that is asked for, and it is known how far one comes.
                Outcome::Infeasible(mut no) if let Some(beyond) = beyond_error(study, &seen) => {
                    if advice == Advice::Changes
                        && let Outcome::Infeasible(advised) = sought(&observer, arm, path, advice)?
                    {
                        no = advised;
                    }
                    nearest_of(&mut no.clauses, beyond);
                    (observer, Outcome::Infeasible(no))
                }
                _ => (positions, Outcome::Designed(seen)),
            });
        }
    }
    let outcome = sought(&observer, arm, path, advice)?;
    Ok((observer, outcome))
}

/// The clauses of two searches, each for itself, that ask for less.
fn nearest_of(clauses: &mut Vec<Clause>, others: Vec<Clause>) {
    let error = clauses.iter().find(|clause| clause.key == ERROR_KEY).map_or(f64::INFINITY, missed);
    if others.iter().map(missed).largest() < error {
        *clauses = others;
    }
}

/// One search, by bounds of joint after joint.
fn estimated(
    study: &Study,
    path: &Path,
    demand: &Demand,
    made: Make<'_>,
) -> Result<Outcome, SessionError> {
    match &study.design.phi {
        PhiSource::Typed { rate, jump } => {
            let typed = made(study, &|joint, _| Phi {
                basis: PhiBasis::Typed,
                source: "typed in the study".to_owned(),
                size_nm: None,
                rate_nm_s: rate[joint],
                jump_nm: jump[joint],
                motion: None,
            })?;
            if let Outcome::Designed(gains) = &typed {
                typed_phi_holds(study, demand, gains).map_err(|e| SessionError::at(path, e))?;
            }
            Ok(typed)
        }
        PhiSource::Trace(file) => {
            let seen = Observed::of(&recorded(study, file)?, study.spec.settle);
            let name = trace_at(file);
            let name = name.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let source = format!("recorded in {name}, times {}", study.design.phi_margin);
            made(study, &|joint, inertia| {
                let seen = seen.phi(joint, inertia).times(study.design.phi_margin);
                bounds(PhiBasis::Trace, &source, seen)
            })
        }
        PhiSource::Simulation => simulated(study, demand, made),
        PhiSource::Reference => made(study, &|joint, inertia| phi_along(demand, joint, inertia)),
    }
}

/// Adds to the gains that were taken what no search needs: how far a push on one joint moves every joint, how fast the
/// arm may move, and what becomes of the tube behind coarser encoders.
fn completed(
    study: &Study,
    arm: &Arm,
    mut outcome: Outcome,
    path: &Path,
) -> Result<Outcome, SessionError> {
    let Outcome::Designed(gains) = &mut outcome else { return Ok(outcome) };
    let mut moving = gains.clone();
    let found = std::thread::scope(|side| {
        // A search on one thread, beside what shares its work among all.
        let side = side.spawn(|| find_moving(&mut moving, arm));
        let found =
            coupled_along(study, gains).map_err(|e| SessionError::at(path, e)).and_then(|one| {
                // A search by tubes has looked at them with its own.
                if !gains.coarser.is_empty() {
                    return Ok((one, gains.coarser.clone()));
                }
                Ok((one, coarser(study, gains).map_err(|e| SessionError::at(path, e))?))
            });
        side.join().unwrap_or_else(|why| std::panic::resume_unwind(why));
        found
    });
    let (coupled, coarser) = found?;
    if let Some(certificate) = &mut moving.certificate {
        certificate.coupled = coupled;
    }
    moving.coarser = coarser;
    *gains = moving;
    Ok(outcome)
}

type Make<'a> = &'a dyn Fn(&Study, &dyn Fn(usize, f64) -> Phi) -> Result<Outcome, SessionError>;

/// `φ` from the closed loop: simulated with gains for `φ` along the reference, designed, simulated again, and
/// designed once more if the second run asks for more than the first one allowed.
fn simulated(study: &Study, demand: &Demand, make: Make<'_>) -> Result<Outcome, SessionError> {
    let margin = study.design.phi_margin;
    let Some(first) = first_gains(study, demand, make)? else {
        return make(study, &|joint, inertia| phi_along(demand, joint, inertia));
    };
    let mut seen = vec![run(study, &first)?];
    for round in 1..=2 {
        let source = format!(
            "{round} simulation(s) of the closed loop, times {margin}; another run may show more"
        );
        let phi = |joint: usize, inertia: f64| {
            let all = seen.iter().map(|seen| seen.phi(joint, inertia)).reduce(PhiAlong::or);
            let all = all.unwrap_or(PhiAlong { size: 0.0, rate: 0.0, jump: 0.0 }).times(margin);
            bounds(PhiBasis::Simulation, &source, all)
        };
        let outcome = make(study, &phi)?;
        let Outcome::Designed(gains) = &outcome else { return Ok(outcome) };
        let again = run(study, gains)?;
        let kept = gains.joints.iter().enumerate().all(|(joint, record)| {
            let (allowed, found) =
                (phi(joint, record.inertia_kg_m2), again.phi(joint, record.inertia_kg_m2));
            found.rate <= allowed.rate_nm_s && found.jump <= allowed.jump_nm
        });
        if kept {
            return Ok(outcome);
        }
        seen.push(again);
    }
    Err(SessionError::other(
        "two rounds of simulation and design do not agree on φ: raise design.phi_margin, or use design.phi_from = \
         \"reference\"",
    ))
}

/// Gains for a first simulation: for `φ` along the reference, the allowed error doubled until there are some.
fn first_gains(
    study: &Study,
    demand: &Demand,
    make: Make<'_>,
) -> Result<Option<Box<Gains>>, SessionError> {
    let mut easier = study.clone();
    for _ in 0..DOUBLINGS {
        let outcome = make(&easier, &|joint, inertia| phi_along(demand, joint, inertia))?;
        if let Outcome::Designed(gains) = outcome {
            return Ok(Some(gains));
        }
        let spec = &mut easier.spec;
        let bounds =
            [&mut spec.error_bound, &mut spec.velocity_error_max, &mut spec.error_integral_max];
        bounds.into_iter().flatten().flatten().for_each(|bound| *bound *= 2.0);
    }
    Ok(None)
}

/// `φ` that is observed in a run with some gains.
fn run(study: &Study, gains: &Gains) -> Result<Observed, SessionError> {
    let mut study = study.clone();
    gains.complete(&mut study).map_err(SessionError::other)?;
    let law = gains
        .joint_gains(&names(&study), study.control.period_ns, study.control.form)
        .map_err(SessionError::other)?;
    let simulation = Simulation::new(&study, &law).map_err(SessionError::other)?;
    let outcome = simulation.run(|_| ());
    if let Some(d) = outcome.divergence {
        let why = format!("the simulation for φ diverged at t = {} s on joint {}", d.t, d.joint);
        return Err(SessionError::other(why));
    }
    Ok(Observed::of(&outcome.trace, study.spec.settle))
}

pub(crate) fn names(study: &Study) -> Vec<String> {
    study.robot.joints.iter().map(|joint| joint.name.clone()).collect()
}

fn bounds(basis: PhiBasis, source: &str, phi: PhiAlong) -> Phi {
    Phi {
        basis,
        source: source.to_owned(),
        size_nm: Some(phi.size),
        rate_nm_s: phi.rate,
        jump_nm: phi.jump,
        motion: None,
    }
}

/// That the trace which φ is to be taken from, if any, can be read.
pub(crate) fn trace_of_phi(study: &Study) -> Result<(), SessionError> {
    match &study.design.phi {
        PhiSource::Trace(file) => recorded(study, file).map(drop),
        _ => Ok(()),
    }
}

/// A recorded trace of the study's arm.
fn recorded(study: &Study, file: &Path) -> Result<Trace, SessionError> {
    let file = &trace_at(file);
    let trace = Trace::read(files::open(file)?, study).map_err(|e| SessionError::at(file, e))?;
    if let Some((t, joint, column)) = trace.not_finite() {
        let why = format!(
            "{column} of joint {joint} at {t} s is no number: nothing is designed from such a run"
        );
        return Err(SessionError::at(file, why));
    }
    if trace.len() < 2 || trace.index_at(study.spec.settle) + 2 > trace.len() {
        let settle = study.spec.settle;
        return Err(SessionError::at(
            file,
            format!("the trace ends before spec.settle_s = {settle} s"),
        ));
    }
    Ok(trace)
}
