//! A gain that is known from both sides, and when a claimed one encloses what is found.

use serde::{Deserialize, Serialize};

use crate::Refutation;

const CLAIM: &str = "performance";

/// Rounding of two ways to compute the same.
const AGAIN: f64 = 1e-8;

/// A number known from both sides.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PeakGain {
    /// The number is at least this.
    pub lower: f64,
    /// The number is at most this: the guarantee.
    pub upper: f64,
}

/// A claimed pair is right when it encloses the true one.
pub(crate) fn encloses(what: &str, claimed: PeakGain, again: PeakGain) -> Result<(), Refutation> {
    let enough = claimed.upper >= again.upper * (1.0 - AGAIN) && claimed.upper.is_finite();
    let above = format!("{what} ≤ its bound");
    Refutation::unless(CLAIM, &above, again.upper, claimed.upper, enough)?;
    let attained = claimed.lower <= again.lower * (1.0 + AGAIN);
    let below = format!("{what} ≥ its lower bound");
    Refutation::unless(CLAIM, &below, again.lower, claimed.lower, attained)?;
    let (low, high) = (claimed.lower, claimed.upper);
    let pair = format!("{what}: 0 ≤ lower bound ≤ bound");
    Refutation::unless(CLAIM, &pair, low, high, 0.0 <= low && low <= high)
}
