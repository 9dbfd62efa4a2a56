//! Why a study cannot be taken further.

use std::error::Error;
use std::fmt;
use std::path::{Path, PathBuf};

use phihat_design::budget::Budget;
use phihat_design::claims::Refutation;
use phihat_design::{GainsError, Infeasible};
use phihat_study::StudyError;

use crate::disk::DiskError;

/// Why a study, its gains or its record cannot be taken further.
#[derive(Debug)]
#[non_exhaustive]
pub enum SessionError {
    /// The study cannot be used; it shows the line that it concerns.
    Study(Box<StudyError>),
    /// A file, or what stands in it, cannot be used.
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        why: Box<dyn Error + Send + Sync>,
    },
    /// The input is fine, and no gains keep what it asks for.
    Infeasible {
        /// The study.
        path: PathBuf,
        /// Clauses that cannot be satisfied.
        no: Box<Infeasible>,
        /// Error budget of the nearest law.
        budget: Option<Box<Budget>>,
    },
    /// Gains may not run on this arm.
    NotArmed {
        /// Source of the gains.
        path: PathBuf,
        /// Claim that does not hold.
        why: Box<Refutation>,
        /// The same in ordinary words, where there are some.
        words: Option<String>,
    },
    /// A recorded run left the tube that its gains promise.
    TubeLeft {
        /// The trace.
        path: PathBuf,
        /// Description of the violation, one sentence.
        sentence: String,
    },
    /// Results cannot be written.
    Disk(DiskError),
    /// Anything else: a simulation that cannot be made, gains that do not fit.
    Other(Box<dyn Error + Send + Sync>),
}

/// Hint for an arm that gains may not run on.
const UNCERTIFIED: &str = "a run with --uncertified shows what happens, and is marked";

impl SessionError {
    /// About a file.
    pub fn at(path: &Path, why: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::File { path: path.to_owned(), why: why.into() }
    }

    /// About no file.
    pub fn other(why: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Other(why.into())
    }

    /// Statement of the proof beyond the words: one sentence.
    pub fn in_full(&self) -> Option<String> {
        match self {
            Self::Infeasible { no, .. } => Some(no.searched()),
            Self::NotArmed { why, words: Some(_), .. } => Some(why.to_string()),
            _ => None,
        }
    }

    /// Returns true if the input can be used, and its specification or its tube does not hold.
    pub fn is_answer(&self) -> bool {
        matches!(self, Self::Infeasible { .. } | Self::TubeLeft { .. })
    }
}

impl fmt::Display for SessionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Study(why) => f.write_str(&why.render()),
            Self::File { path, why } => write!(f, "{}: {why}", path.display()),
            Self::Infeasible { path, no, .. } => write!(f, "{}: {no}", path.display()),
            Self::NotArmed { path, why, words } => {
                write!(f, "{}: not armed: ", path.display())?;
                match words {
                    Some(words) => write!(f, "{}: {words}", why.claim)?,
                    None => write!(f, "{why}")?,
                }
                write!(f, "\n  = help: {UNCERTIFIED}")
            }
            Self::TubeLeft { path, sentence } => write!(f, "{}: {sentence}", path.display()),
            Self::Disk(why) => why.fmt(f),
            Self::Other(why) => why.fmt(f),
        }
    }
}

impl Error for SessionError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Study(why) => Some(why),
            Self::File { why, .. } | Self::Other(why) => Some(why.as_ref()),
            Self::NotArmed { why, .. } => Some(why),
            Self::Disk(why) => Some(why),
            Self::Infeasible { .. } | Self::TubeLeft { .. } => None,
        }
    }
}

impl From<StudyError> for SessionError {
    fn from(why: StudyError) -> Self {
        Self::Study(Box::new(why))
    }
}

impl From<GainsError> for SessionError {
    fn from(why: GainsError) -> Self {
        Self::other(why)
    }
}

impl From<DiskError> for SessionError {
    fn from(why: DiskError) -> Self {
        Self::Disk(why)
    }
}
