//! The continuous law of one joint at unit inertia, and the answer of a claim that does not hold.

pub use phihat_certificate::{Refutation, UnitLaw};

/// `Ok` when `truth`; otherwise the refutation. A NaN anywhere makes `truth` false.
pub(crate) fn holds(
    claim: &str,
    inequality: &str,
    left: f64,
    right: f64,
    truth: bool,
) -> Result<(), Refutation> {
    Refutation::unless(claim, inequality, left, right, truth)
}

/// `Ok` when two numbers agree to the relative tolerance.
pub(crate) fn agrees(
    claim: &str,
    what: &str,
    left: f64,
    right: f64,
    tolerance: f64,
) -> Result<(), Refutation> {
    let scale = left.abs().max(right.abs());
    holds(claim, what, left, right, (left - right).abs() <= tolerance * scale)
}
