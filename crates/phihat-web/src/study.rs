//! A study and its arm from texts to gains, run and page.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use phihat_design::Outcome;
use phihat_report::Picture;
use phihat_session::{
    ArmOptions, BeginOptions, Done, Session, begun, check_text, described, designed_in_steps,
};
use phihat_sim::Trace;
use phihat_synthesis::{Advice, Steps};
use serde_json::{Value, json};

use crate::drawn::{beginning, drawn, part, part_samples};
use crate::error::AnswerError;
use crate::form::{FORM, values};
use crate::task::{StudyTexts, named};

/// Joints and notes of a description.
pub(crate) fn arm(file: &str, files: &BTreeMap<String, String>) -> Result<Value, AnswerError> {
    let (robot, _, notes) = described(&arm_options(file, files))?;
    let notes: Vec<&String> = notes.iter().chain(&robot.warnings).collect();
    Ok(json!({ "name": robot.name, "joints": robot.joint_names(), "notes": notes }))
}

/// A study made of an arm, with the files that it names.
pub(crate) fn begun_with(
    options: BeginOptions,
    event: &dyn Fn(Value),
) -> Result<Value, AnswerError> {
    if !(options.payload_kg.is_finite() && options.payload_kg >= 0.0) {
        return Err(AnswerError::Payload(options.payload_kg));
    }
    let options = BeginOptions { out: PathBuf::from("study.toml"), ..options };
    let mut step = |step: &str| event(json!({ "step": step }));
    let (begun, texts) = begun(&options, &mut step)?;
    let name = |path: &Path| path.file_name().unwrap_or_default().display().to_string();
    let mut texts: BTreeMap<String, String> =
        texts.iter().map(|(path, text)| (name(path), text.clone())).collect();
    let study = texts.remove("study.toml").unwrap_or_default();
    let gains = begun.gains.map(|gains| gains.to_json()).transpose()?;
    Ok(json!({
        "study": study, "files": texts, "gains": gains, "notes": begun.notes, "error_bound_rad": begun.error_bound,
        "infeasible": begun.infeasible,
    }))
}

/// Mistakes of a study, its warnings, and the values of the form.
pub(crate) fn checked(texts: &StudyTexts) -> Value {
    // A run that is too long is too long to look along, too.
    if let Err(long @ AnswerError::Long { .. }) = texts.read() {
        let errors = [json!({ "line": null, "column": null, "text": long.to_string() })];
        return json!({ "errors": errors, "warnings": [], "form": FORM, "values": values(&texts.study) });
    }
    let check = check_text(&texts.study, &texts.path(), &named(&texts.files));
    let errors: Vec<Value> = check
        .errors
        .iter()
        .map(|own| json!({ "line": own.line, "column": own.column, "text": own.to_string() }))
        .collect();
    json!({ "errors": errors, "warnings": check.warnings, "form": FORM, "values": values(&texts.study) })
}

/// Gains for a study, or why there are none.
pub(crate) fn designed_from(
    texts: &StudyTexts,
    event: &dyn Fn(Value),
) -> Result<Value, AnswerError> {
    let (study, path) = (texts.read()?, texts.path());
    let arm = phihat_session::arm(&study, &path)?;
    let begins = |step: &str| {
        event(json!({ "step": step }));
        ControlFlow::Continue(())
    };
    let steps = (Advice::Clauses, Steps::to(&begins));
    let outcome = designed_in_steps(&study, &arm, &path, steps)?;
    match outcome {
        Outcome::Designed(gains) => {
            let text = gains.to_json()?;
            Ok(json!({ "gains": text, "infeasible": null }))
        }
        Outcome::Infeasible(no) => Ok(json!({ "gains": null, "infeasible": no.to_string() })),
    }
}

/// A run, and what a page draws of it.
pub(crate) fn run(texts: &StudyTexts, event: &dyn Fn(Value)) -> Result<Value, AnswerError> {
    let (done, trace) = finished(texts, event)?;
    Ok(drawn(&done, &trace))
}

/// The page of a run, as the command line writes it.
pub(crate) fn page(texts: &StudyTexts, event: &dyn Fn(Value)) -> Result<Value, AnswerError> {
    let (done, _) = finished(texts, event)?;
    Ok(json!({ "page": phihat_report::page(&done.record()) }))
}

/// Every figure of a run as the command line writes it, by its name.
pub(crate) fn figures(texts: &StudyTexts, event: &dyn Fn(Value)) -> Result<Value, AnswerError> {
    let (done, _) = finished(texts, event)?;
    let figure = |own: Picture| json!({ "name": own.name, "title": own.title, "svg": own.svg });
    let figures: Vec<Value> =
        phihat_report::figures(&done.record()).into_iter().map(figure).collect();
    Ok(json!({ "figures": figures }))
}

fn finished(texts: &StudyTexts, event: &dyn Fn(Value)) -> Result<(Done, Trace), AnswerError> {
    let given = texts.gains()?;
    let study = texts.read()?;
    // A page makes its view of the arm while the session looks whether these gains may run on it, and says what is
    // wrong with the study.
    if let Ok(beginning) = beginning(&study, given.as_ref()) {
        event(json!({ "beginning": beginning }));
    }
    let given = given.map(|gains| (gains, Path::new("gains.json")));
    let samples = part_samples(&study);
    let of = phihat_sim::samples(study.duration, study.control.period_ns);
    let session = Session::new(study, &texts.path(), given, false)?;
    let mut so_far = 0;
    Ok(session.run_in_parts(samples, |trace| {
        so_far += trace.len();
        event(json!({ "part": part(trace, samples), "samples": so_far, "of": of }));
    }))
}

/// An arm among the texts.
pub(crate) fn arm_options(file: &str, files: &BTreeMap<String, String>) -> ArmOptions {
    ArmOptions { arm: file.to_owned(), files: named(files), ..ArmOptions::default() }
}
