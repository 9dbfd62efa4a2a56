//! Why a rival does not run.

use thiserror::Error;

/// Why a rival cannot be built for an arm and a tuning. An outcome, not a fault.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RivalRefusal {
    /// The law does not apply to this arm or task; the text says why.
    #[error("does not apply: {0}")]
    NotApplicable(String),
    /// The tuning is not one of the law's.
    #[error("{0}")]
    Tuning(String),
}
