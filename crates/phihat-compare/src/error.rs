//! Why there is no comparison.

use std::error::Error;
use std::path::PathBuf;

use phihat_campaign::JournalError;
use phihat_session::SessionError;
use phihat_session::disk::DiskError;
use phihat_study::StudyError;
use thiserror::Error;

/// Why a comparison cannot be made, run or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A study cannot be read, or not in one of the worlds.
    #[error("{}", .0.render())]
    Study(Box<StudyError>),
    /// A study does not fit a comparison.
    #[error("{}: {why}", path.display())]
    Unfit {
        /// The study.
        path: PathBuf,
        /// Why.
        why: Box<dyn Error + Send + Sync>,
    },
    /// A run cannot begin.
    #[error("{0}")]
    Begin(Box<dyn Error + Send + Sync>),
    /// No rival has such an id.
    #[error("there is no rival `{0}`")]
    Rival(String),
    /// A law of somebody's own has the name of another.
    #[error("there is a law `{0}` already: another name is needed")]
    Taken(String),
    /// No world has such a name.
    #[error("there is no world `{0}`")]
    World(String),
    /// No run has such a name.
    #[error("there is no run `{0}`; names are ARM/RIVAL/WORLD/default|tuned/SEED")]
    Run(String),
    /// One run is to be repeated, and rivals or worlds are chosen beside it.
    #[error("--trace names one run, with its rival and its world: leave out --only and --worlds")]
    OneRun,
    /// A result cannot be written.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A run's files cannot be written.
    #[error(transparent)]
    Disk(#[from] DiskError),
    /// The journal cannot be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The answer cannot be written.
    #[error("{0}")]
    Answer(serde_json::Error),
}

impl From<StudyError> for CompareError {
    fn from(why: StudyError) -> Self {
        Self::Study(Box::new(why))
    }
}
