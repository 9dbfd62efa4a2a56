//! Equalities between what a document says and what it should.

use crate::Refutation;

/// `Ok` when two numbers agree to a relative tolerance.
pub(crate) fn agrees(
    claim: &str,
    what: &str,
    (left, right): (f64, f64),
    tolerance: f64,
) -> Result<(), Refutation> {
    let scale = left.abs().max(right.abs());
    let same = (left - right).abs() <= tolerance * scale && scale.is_finite();
    Refutation::unless(claim, what, left, right, same)
}
