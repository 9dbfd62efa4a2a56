//! A synthesis for a study file: its recordings from the disk, and errors that name their file.

use std::path::Path;

use phihat_design::budget::Budget;
use phihat_design::{Arm, Gains, Outcome};
use phihat_model::NamedTexts;
use phihat_sim::Trace;
use phihat_study::{InertiaSource, PhiSource, Study};
use phihat_synthesis::{
    Advice, BudgetSearch, Recording, Recordings, Steps, SynthesisError, SynthesisOptions,
    synthesize_in_steps,
};

use crate::confirmed::confirmed;
use crate::error::SessionError;
use crate::files;
use crate::origin::trace_at;
use crate::watch::Watch;

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

/// A study from its text, and from those of the files that it names; `path` is where it would stand.
///
/// # Errors
///
/// [`SessionError::Study`]
pub fn study_of_texts(
    text: &str,
    path: &Path,
    files: &NamedTexts,
) -> Result<Box<Study>, SessionError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut study =
        Study::from_texts(text, &path.display().to_string(), (folder, files)).map(Box::new)?;
    phihat_sim::derive_substeps(&mut study);
    Ok(study)
}

/// The arm, from whatever source the study names: description, typed inertia, or a recorded trace.
///
/// # Errors
///
/// [`SessionError`]: the source cannot be used, or contradicts the description.
pub fn arm(study: &Study, path: &Path) -> Result<Arm, SessionError> {
    let recordings = Recordings { inertia: of_inertia(study)?, phi: None };
    phihat_synthesis::arm(study, &recordings).map_err(|why| at(path, why))
}

/// Gains for a study, from its arm and `φ`; without changes of the loop that would help.
///
/// # Errors
///
/// [`SessionError`]: the synthesis cannot begin. That no gains exist is an [`Outcome`].
pub fn designed(study: &Study, path: &Path) -> Result<Outcome, SessionError> {
    designed_for(study, &arm(study, path)?, path, Advice::Clauses)
}

/// Gains for a study and its arm; see [`phihat_synthesis::synthesize()`]. `path` stands for the study in messages.
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
    designed_in_steps(study, arm, path, (advice, Steps::UNHEARD))
}

/// As [`designed_for`], with a listener to the steps of the synthesis, which can end it.
///
/// # Errors
///
/// As [`designed_for`]; that it was cancelled.
pub fn designed_in_steps(
    study: &Study,
    arm: &Arm,
    path: &Path,
    (advice, steps): (Advice, Steps<'_>),
) -> Result<Outcome, SessionError> {
    found(study, arm, path, (SynthesisOptions { advice, beyond_drives: false }, steps))
}

/// As [`designed_for`], of a motion that the drives are known to bear or that shall go beyond them.
pub(crate) fn designed_beyond(
    study: &Study,
    arm: &Arm,
    path: &Path,
) -> Result<Outcome, SessionError> {
    let options = SynthesisOptions { advice: Advice::Clauses, beyond_drives: true };
    found(study, arm, path, (options, Steps::UNHEARD))
}

/// The outcome of a synthesis whose bounds the second derivation confirms, where there is one.
fn found(
    study: &Study,
    arm: &Arm,
    path: &Path,
    (options, steps): (SynthesisOptions, Steps<'_>),
) -> Result<Outcome, SessionError> {
    let recordings = recordings(study)?;
    let synthesize = |own: &Study| synthesize_in_steps(own, (arm, &recordings), options, steps);
    let outcome =
        synthesize(study).and_then(|outcome| confirmed(study, outcome, steps, &synthesize));
    outcome.map_err(|why| at(path, why))
}

/// Error budget of a study; see [`phihat_synthesis::budget`].
///
/// # Errors
///
/// [`SessionError`]: the study's arm cannot follow its reference.
pub fn budget(
    study: &Study,
    arm: &Arm,
    path: &Path,
    of: (&Outcome, BudgetSearch),
    watch: &mut dyn Watch,
) -> Result<Budget, SessionError> {
    let recordings = recordings(study)?;
    let step = &mut |step: &str| watch.step(step);
    let budget = phihat_synthesis::budget(study, (arm, &recordings), of, step);
    watch.ended();
    budget.map_err(|why| at(path, why))
}

/// Adds to gains their distance from the bound that no linear law undercuts; see [`phihat_synthesis::beside_limits`].
///
/// # Errors
///
/// [`SessionError`]: the study's arm cannot follow its reference, or the gains lack what the study leaves to them.
pub fn beside_limits(
    study: &Study,
    gains: &mut Gains,
    watch: &mut dyn Watch,
) -> Result<(), SessionError> {
    let step = &mut |step: &str| watch.step(step);
    let warnings = phihat_synthesis::beside_limits(study, gains, step);
    watch.ended();
    warnings.map_err(SessionError::other)?.iter().for_each(|line| watch.warn(line));
    Ok(())
}

/// Checks that the recording which `φ` is taken from, if any, can be read.
pub(crate) fn trace_of_phi(study: &Study) -> Result<(), SessionError> {
    of_phi(study).map(drop)
}

/// The error of a synthesis, about its own file or the study's.
pub(crate) fn at(path: &Path, why: SynthesisError) -> SessionError {
    let file = why.file().unwrap_or(path).to_owned();
    SessionError::at(&file, why)
}

fn recordings(study: &Study) -> Result<Recordings, SessionError> {
    Ok(Recordings { inertia: of_inertia(study)?, phi: of_phi(study)? })
}

fn of_inertia(study: &Study) -> Result<Option<Recording>, SessionError> {
    match &study.design.inertia {
        InertiaSource::Trace(file) => recorded(study, file).map(Some),
        _ => Ok(None),
    }
}

fn of_phi(study: &Study) -> Result<Option<Recording>, SessionError> {
    match &study.design.phi {
        PhiSource::Trace(file) => recorded(study, file).map(Some),
        _ => Ok(None),
    }
}

/// A recorded trace of the study's arm.
fn recorded(study: &Study, file: &Path) -> Result<Recording, SessionError> {
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
    Ok(Recording { file: file.clone(), trace })
}
