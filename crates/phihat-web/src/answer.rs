//! The answer to a task.

use phihat_session::BeginOptions;
use serde_json::{Value, json};

use crate::error::AnswerError;
use crate::task::BrowserTask;
use crate::{beside, documents, form, study};

/// Answers a task, both as JSON documents; `event` receives `{"step": …}` and `{"samples": …, "of": …}` on the way.
///
/// An answer with `error` says what is wrong with the task or its texts, as the command line would.
pub fn answer(task: &str, event: &dyn Fn(&str)) -> String {
    let told = |value: Value| event(&value.to_string());
    let answer = serde_json::from_str(task)
        .map_err(AnswerError::from)
        .and_then(|task| answered(task, &told))
        .unwrap_or_else(|error| json!({ "error": error.to_string() }));
    answer.to_string()
}

fn answered(task: BrowserTask, event: &dyn Fn(Value)) -> Result<Value, AnswerError> {
    match task {
        BrowserTask::Arm { file, files } => study::arm(&file, &files),
        BrowserTask::Begin { file, files, payload_kg, error_rad, first_kept } => {
            let options = BeginOptions {
                arm: study::arm_options(&file, &files),
                payload_kg,
                error_bound: error_rad,
                first_kept,
                ..BeginOptions::default()
            };
            study::begun_with(options, event)
        }
        BrowserTask::Check(texts) => Ok(study::checked(&texts)),
        BrowserTask::Set { study, key, value } => {
            form::changed(&study, &key, &value).map(|study| json!({ "study": study }))
        }
        BrowserTask::Design(texts) => study::designed_from(&texts, event),
        BrowserTask::Run(texts) => study::run(&texts, event),
        BrowserTask::Beside(texts) => beside::run(&texts, event),
        BrowserTask::Happens(what) => what.study_text().map(|study| json!({ "study": study })),
        BrowserTask::Page(texts) => study::page(&texts, event),
        BrowserTask::Figures(texts) => study::figures(&texts, event),
        BrowserTask::Verify(texts) => documents::verified(&texts),
        BrowserTask::Export { gains, format } => documents::exported(&gains, &format),
    }
}
