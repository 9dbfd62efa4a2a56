//! Why rollouts cannot be made or run.

use phihat_session::SessionError;
use phihat_study::StudyError;
use thiserror::Error;

use crate::sweep::RunError;

/// Why rollouts cannot be made or run.
#[derive(Debug, Error)]
pub enum RolloutsError {
    /// What is told has no place in the study.
    #[error("{name}: {why}")]
    Key {
        /// What it is called.
        name: String,
        /// Why.
        why: String,
    },
    /// A number cannot be.
    #[error("{name}{at} = {value}: it must be {limit}")]
    Value {
        /// What it is called.
        name: String,
        /// Its place.
        at: String,
        /// The number.
        value: f64,
        /// What would be valid.
        limit: String,
    },
    /// There are not as many numbers as runs.
    #[error("{name}: values for {found} runs; there are {runs} runs")]
    Count {
        /// What it is called.
        name: String,
        /// How many there are.
        found: usize,
        /// How many there should be.
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
        /// What it was told.
        told: String,
        /// Why.
        why: Box<RunError>,
    },
    /// The study or its gains.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// Whoever looked on ended it.
    #[error("stopped")]
    Stopped,
}

/// What is wrong with a key, without the line of a text that nobody wrote.
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
