//! Why a design does not come to an outcome.

use thiserror::Error;

use crate::arm::ArmError;
use crate::claims::{PaperError, Refutation};

/// Why a design cannot begin.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DesignError {
    /// The study does not say which error is allowed.
    #[error("spec.error_bound_rad is missing: a design needs the largest error you can live with")]
    NoSpec,
    /// The paper's recipe lacks a limit.
    #[error("{0} is missing: the paper's recipe starts from φ_max and limits on ∫e, e and ė")]
    PaperSpec(&'static str),
    /// The paper's recipe has no gains for these limits.
    #[error("the paper's recipe: {0}")]
    Paper(#[from] PaperError),
    /// The arm's inertia cannot be found.
    #[error("{0}")]
    Arm(#[from] ArmError),
    /// A claim that the search relies on cannot be made.
    #[error("{0}")]
    Claim(#[from] Refutation),
}
