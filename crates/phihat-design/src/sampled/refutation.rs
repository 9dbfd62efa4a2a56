//! Why a claim is refused.

use core::fmt;

use serde::{Deserialize, Serialize};

/// A claim that did not survive its check: the inequality that fails, with its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Refutation {
    /// Which claim.
    pub claim: String,
    /// The inequality that was to hold, in words and symbols.
    pub inequality: String,
    /// Its left side.
    pub left: f64,
    /// Its right side.
    pub right: f64,
}

impl Refutation {
    pub(crate) fn new(claim: &str, inequality: impl Into<String>, left: f64, right: f64) -> Self {
        Self { claim: claim.to_owned(), inequality: inequality.into(), left, right }
    }
}

impl fmt::Display for Refutation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} fails: {} against {}", self.claim, self.inequality, self.left, self.right)
    }
}

impl core::error::Error for Refutation {}

/// `Err` unless `left <= right` (a NaN fails).
pub(crate) fn at_most(
    claim: &str,
    inequality: &str,
    left: f64,
    right: f64,
) -> Result<(), Refutation> {
    if left <= right { Ok(()) } else { Err(Refutation::new(claim, inequality, left, right)) }
}
