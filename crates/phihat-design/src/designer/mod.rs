//! From a specification to gains with a certificate, or a "no" with its reason.

mod infeasible;
mod paper;
mod search;
mod verdict;

use phihat_study::{DesignMethod, Study};
use thiserror::Error;

pub use infeasible::{Clause, Infeasible};

use crate::arm::{Arm, ArmError};
use crate::claims::{PaperError, Refutation};
use crate::gains::Gains;
use crate::phi::Phi;
use search::Search;
use verdict::Nearest;

/// What is known of `φ` for a joint and its nominal inertia.
pub type PhiOf<'a> = &'a dyn Fn(usize, f64) -> Phi;

/// What a design came to.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Outcome {
    /// Gains with their certificate: by our method they keep every clause; by the paper's the certificate says
    /// what holds.
    Designed(Box<Gains>),
    /// No gains keep every clause.
    Infeasible(Infeasible),
}

/// Why a design cannot begin.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DesignError {
    /// The study does not say which error is allowed.
    #[error("spec.error_max_rad is missing: a design needs the largest error you can live with")]
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

/// Finds gains that keep a study's specification, by the method it asks for.
///
/// # Method
///
/// All joints share `K_p = ω²`, `K_d = 2ω` and the estimator (all poles at `ω_o`), so that the eigenvalue
/// argument holds for the coupled arm; `M̄` is a common factor times each joint's own. Over a grid of
/// order, `ω`, `ω_o/ω`, that factor and, where it is left to the design, the velocity filter: those that keep
/// the inertia window with its margin, in the order of the torque that encoder steps cause; the first whose
/// certified bounds keep the specification is taken. Where none does, the search goes on between the points of
/// the grid.
///
/// # Errors
///
/// [`DesignError`]. That no gains exist is an [`Outcome`].
pub fn design(study: &Study, arm: &Arm, phi: PhiOf<'_>) -> Result<Outcome, DesignError> {
    if study.design.method == DesignMethod::Paper {
        return paper::design(study, arm, phi).map(|gains| Outcome::Designed(Box::new(gains)));
    }
    let search = Search::new(study, arm, phi)?;
    let (mut candidates, tried) = search.candidates();
    candidates.sort_by(|a, b| a.noise().total_cmp(&b.noise()));
    let stable = u32::try_from(candidates.len()).unwrap_or(u32::MAX);
    let mut nearest = Nearest::default();
    for candidate in &candidates {
        let verdict = search.judge(candidate);
        if verdict.within()
            && let Some(mut gains) = search.certify(candidate)?
        {
            gains.trade_off = search.trade_off(&candidates, candidate);
            return Ok(Outcome::Designed(Box::new(gains)));
        }
        nearest.note(&verdict);
    }
    Ok(Outcome::Infeasible(Infeasible { clauses: search.clauses(&nearest), tried, stable }))
}
