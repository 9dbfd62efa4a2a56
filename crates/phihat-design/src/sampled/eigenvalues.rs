//! Eigenvalues whose search has an end.

use nalgebra::{Complex, DMatrix, DVector, Schur};

/// Rounds of the search.
const ROUNDS: usize = 10_000;

/// The eigenvalues of a matrix; `None` where the iteration does not converge. That of `complex_eigenvalues`
/// goes on for ever where rounding keeps it from its end: the attack met a law of third order behind four
/// samples of delay with such a matrix.
pub(crate) fn eigenvalues(a: DMatrix<f64>) -> Option<DVector<Complex<f64>>> {
    Schur::try_new(a, f64::EPSILON, ROUNDS).map(|schur| schur.complex_eigenvalues())
}
