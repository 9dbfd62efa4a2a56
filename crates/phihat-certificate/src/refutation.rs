//! The answer of a claim that does not hold.

use core::fmt;

use serde::{Deserialize, Serialize};

/// A claim that does not hold: the inequality that fails, with both its sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refutation {
    /// Name of the claim.
    pub claim: String,
    /// The inequality as a formula; it should hold and does not.
    pub inequality: String,
    /// Value of its left side.
    pub left: f64,
    /// Value of its right side.
    pub right: f64,
}

impl Refutation {
    /// `Ok` when `truth`; otherwise the refutation. A NaN anywhere makes `truth` false.
    ///
    /// # Errors
    ///
    /// The refutation.
    pub fn unless(
        claim: &str,
        inequality: &str,
        left: f64,
        right: f64,
        truth: bool,
    ) -> Result<(), Self> {
        if truth {
            return Ok(());
        }
        Err(Self { claim: claim.to_owned(), inequality: inequality.to_owned(), left, right })
    }

    /// This refutation, with the joint's name in front of the claim.
    #[must_use]
    pub fn on(mut self, joint: &str) -> Self {
        self.claim = format!("{joint}: {}", self.claim);
        self
    }
}

impl fmt::Display for Refutation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { claim, inequality, left, right } = self;
        write!(f, "{claim}: {inequality} fails with {left:.9e} against {right:.9e}")
    }
}

impl core::error::Error for Refutation {}

/// A refutation in one line.
pub(crate) fn refuse(claim: &str, inequality: &str, left: f64, right: f64) -> Refutation {
    Refutation { claim: claim.to_owned(), inequality: inequality.to_owned(), left, right }
}
