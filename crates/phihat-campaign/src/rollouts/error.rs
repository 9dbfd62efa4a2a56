//! Why rollouts cannot be made or run.

use phihat_session::SessionError;
use phihat_study::StudyError;
use thiserror::Error;

use crate::sweep::RunError;

/// Why rollouts cannot be made or run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RolloutsError {
    /// Numbers that cannot be set in the study.
    #[error("{name}: {why}")]
    Key {
        /// Name of the numbers.
        name: String,
        /// Why.
        why: String,
    },
    /// A number cannot be.
    #[error("{name}{at} = {value}: it must be {limit}")]
    Value {
        /// Name of the numbers.
        name: String,
        /// Its place.
        at: String,
        /// The number.
        value: f64,
        /// Valid values.
        limit: String,
    },
    /// There are not as many numbers as runs.
    #[error("{name}: values for {found} runs; there are {runs} runs")]
    Count {
        /// Name of the numbers.
        name: String,
        /// Number of runs that have values.
        found: usize,
        /// Number of runs.
        runs: usize,
    },
    /// A signal that there is not, or that cannot be kept so.
    #[error("{0}")]
    Keep(String),
    /// A run cannot begin.
    #[error("run {run} ({told}): {}", of_run(why))]
    Run {
        /// Its place.
        run: usize,
        /// Numbers and seed of the run.
        told: String,
        /// Why.
        why: Box<RunError>,
    },
    /// The study or its gains.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// `watch` ended the rollouts.
    #[error("stopped")]
    Stopped,
}

/// Message of an error in a key, without the line: the user did not write that text.
pub(super) fn in_words(why: &StudyError) -> String {
    let help = why.help().map(|help| format!("; {help}")).unwrap_or_default();
    let key = if why.key().is_empty() { String::new() } else { format!("{}: ", why.key()) };
    format!("{key}{}{help}", why.message())
}

fn of_run(why: &RunError) -> String {
    match why {
        RunError::Study(why) => in_words(why),
        other => other.to_string(),
    }
}
