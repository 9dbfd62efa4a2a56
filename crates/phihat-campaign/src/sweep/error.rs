//! Why a sweep cannot be made, run, merged or written.

use std::path::PathBuf;

use phihat_session::SessionError;
use phihat_session::disk::DiskError;
use phihat_study::StudyError;
use thiserror::Error;

use crate::chunks::ChunksError;
use crate::journal::JournalError;

/// Why a sweep cannot be made, run, merged or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SweepError {
    /// A study has no such number.
    #[error("{0}")]
    Key(Box<StudyError>),
    /// Something cannot vary so.
    #[error("--vary {text}: {why}")]
    Vary {
        /// As it was written.
        text: String,
        /// Why.
        why: String,
    },
    /// One key varies twice.
    #[error("--vary {0}: it varies twice")]
    Twice(String),
    /// Nothing varies.
    #[error("nothing varies: write --vary KEY=RANGE, as in --vary world.payload.mass_kg=0..2")]
    Nothing,
    /// An end of a range makes a study that cannot run.
    #[error("--vary {text}: with {value} the study cannot run: {why}")]
    Unfit {
        /// As it was written.
        text: String,
        /// The value.
        value: f64,
        /// Why.
        why: Box<RunError>,
    },
    /// No such part of a sweep.
    #[error("--shard {0}: write K/N, the K-th of N parts, as in 3/8")]
    Shard(String),
    /// A folder holds no finished shard of a sweep.
    #[error("{}: {why}", path.display())]
    NoShard {
        /// The folder or file.
        path: PathBuf,
        /// Reason.
        why: String,
    },
    /// Shards of a sweep that are not there, or not finished.
    #[error(
        "shards {missing} of {count} are missing: run them with the same command and --shard K/{count}"
    )]
    Missing {
        /// Numbers of the missing shards.
        missing: String,
        /// Number of all shards.
        count: u64,
    },
    /// A study, gains or a result.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The journal.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The rows.
    #[error(transparent)]
    Chunks(#[from] ChunksError),
    /// The results.
    #[error(transparent)]
    Disk(#[from] DiskError),
    /// A document.
    #[error("{0}")]
    Document(#[from] serde_json::Error),
}

impl From<StudyError> for SweepError {
    fn from(why: StudyError) -> Self {
        Self::Key(Box::new(why))
    }
}

/// Why a run cannot begin.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RunError {
    /// Its study is none.
    #[error("{0}")]
    Study(#[from] StudyError),
    /// The gains do not fit it.
    #[error("{0}")]
    Gains(#[from] phihat_design::GainsError),
    /// It cannot be simulated.
    #[error("{0}")]
    Sim(#[from] phihat_sim::SimError),
}
