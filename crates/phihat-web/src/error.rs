//! Reason why a task has no answer.

use phihat_design::GainsError;
use phihat_design::export::ExportError;
use phihat_session::SessionError;
use thiserror::Error;

/// Reason why a task has no answer.
#[derive(Debug, Error)]
pub(crate) enum AnswerError {
    /// The task is none.
    #[error("task: {0}")]
    Task(#[from] serde_json::Error),
    /// The study, its arm or its run.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The gains document.
    #[error("gains.json: {0}")]
    Gains(#[from] GainsError),
    /// Gains in another format.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A check without gains.
    #[error("give gains: a gains.json")]
    NoGains,
    /// A run that a browser's memory does not take.
    #[error(
        "duration_s: {samples} samples of {joints} joints, and a run in a browser has at most {most} together: a \
         shorter one, or a lower loop.rate_hz"
    )]
    Long {
        /// Samples of the run.
        samples: u64,
        /// Joints of the arm.
        joints: usize,
        /// Most samples, those of its joints counted each.
        most: u64,
    },
    /// A payload that is none.
    #[error("payload_kg = {0}: a finite number, at least 0")]
    Payload(f64),
    /// A format that nothing is exported to.
    #[error("format \"{0}\": c-header, ros2 or csv")]
    Format(String),
    /// A key that the form does not have.
    #[error("key \"{0}\": not one of the form's")]
    Key(String),
    /// A key whose section is none.
    #[error("key \"{0}\": no section")]
    Section(String),
    /// A value that is no TOML.
    #[error("{key} = {value}: no value; a number such as 0.5, or a text in quotes")]
    Value {
        /// Key of the form.
        key: String,
        /// Text that was given for it.
        value: String,
    },
    /// A text that is no TOML.
    #[error("study: {0}")]
    Toml(#[from] toml_edit::TomlError),
}
