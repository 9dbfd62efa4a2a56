//! A part of the reproduction: how much of it is done, what it gives, and why it could not be done.

use phihat::GainError;
use phihat_compare::CompareError;
use phihat_design::claims::{PaperError, Refutation};
use phihat_design::{ArmError, GainsError};
use phihat_model::ModelError;
use phihat_rivals::RivalRefusal;
use phihat_sim::SimError;
use phihat_study::StudyError;
use thiserror::Error;

use crate::record::{Assumption, Section};

/// Extent of the computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Extent {
    /// Coarser maps and sweeps, for tests; what is in both is the same.
    pub quick: bool,
}

/// Result of one part of the reproduction.
#[derive(Debug, Clone, Default)]
pub struct PaperPart {
    /// Assumptions that it needed.
    pub assumptions: Vec<Assumption>,
    /// Its sections, in the order of the paper.
    pub sections: Vec<Section>,
}

/// Why a part could not be done: a fault of this program or of a study.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PartError {
    /// A study cannot be read.
    #[error(transparent)]
    Study(Box<StudyError>),
    /// There is no study of this path.
    #[error("no study {0}")]
    NoStudy(String),
    /// The gains of a study do not make a law.
    #[error("{study}: {why}")]
    UnitLaw {
        /// The study.
        study: String,
        /// Why.
        why: GainsError,
    },
    /// A study cannot be run.
    #[error("{study}: {why}")]
    Run {
        /// The study.
        study: String,
        /// Why.
        why: SimError,
    },
    /// A run of a rival cannot begin.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// A rival does not apply.
    #[error(transparent)]
    Rival(#[from] RivalRefusal),
    /// There is no law of this id.
    #[error("no law {0}")]
    NoLaw(String),
    /// The nominal model cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The inertia of an arm cannot be computed.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// Gains of a joint are refused.
    #[error(transparent)]
    Gains(#[from] GainError),
    /// A claim about a law is refuted where the paper needs it.
    #[error(transparent)]
    Refuted(#[from] Refutation),
    /// The paper's conditions give no gains.
    #[error(transparent)]
    Conditions(#[from] PaperError),
    /// Something that the part computes with is missing.
    #[error("{0}")]
    Missing(&'static str),
    /// A study of this path states no gains.
    #[error("{0} states no gains")]
    NoGains(&'static str),
    /// A law has no certificate.
    #[error("{0} has no certificate")]
    NoCertificate(&'static str),
    /// A set of gains was not run.
    #[error("{0} did not run")]
    NotRun(&'static str),
    /// The laws of Table 1 cannot be compared.
    #[error(transparent)]
    Comparison(Box<CompareError>),
    /// No law stands for a row of Table 1.
    #[error("Table 1: no law stands for {0}")]
    EmptyRow(String),
    /// The laws of a row of Table 1 bear different marks.
    #[error("Table 1: the laws of row {0} bear different marks")]
    MixedRow(String),
}

impl From<StudyError> for PartError {
    fn from(why: StudyError) -> Self {
        Self::Study(Box::new(why))
    }
}
