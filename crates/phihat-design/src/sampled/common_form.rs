//! One quadratic form for two systems that differ by a matrix of rank one: search, existence, definiteness.

use nalgebra::{DMatrix, DVector};
use phihat_certificate::extremes::larger;

use super::eigenvalues::eigenvalues;
use super::refutation::refuse;
use super::riccati;
use crate::claims::Refutation;
use crate::claims::matrix::RationalMatrix;

/// The test of Shorten and Narendra for `A_1`, `A_2` of continuous systems that differ by rank one, by
/// eigenvalues: quick, and not trusted.
pub(crate) fn exists(
    claim: &str,
    fast: &DMatrix<f64>,
    slow: &DMatrix<f64>,
) -> Result<(), Refutation> {
    for (what, a) in [("A(low) is Hurwitz", fast), ("A(high) is Hurwitz", slow)] {
        let worst = eigenvalues(a.clone())
            .map_or(f64::NAN, |all| all.iter().map(|z| z.re).fold(f64::NEG_INFINITY, larger));
        if worst.is_nan() || worst >= 0.0 {
            return Err(refuse(claim, what, worst, 0.0));
        }
    }
    let what = "the eigenvalues of A(low)A(high) are found";
    let product = eigenvalues(fast * slow).ok_or_else(|| refuse(claim, what, 0.0, 1.0))?;
    for z in product.iter() {
        if z.re < 0.0 && z.im.abs() < 1e-9 * z.re.abs() {
            let what = "A(low)A(high) has no negative real eigenvalue";
            return Err(refuse(claim, what, z.re, 0.0));
        }
    }
    Ok(())
}

/// The first `P` that survives its proof, for `A_1 = A_2 − b cᵀ`.
///
/// # Method
///
/// With `A_2ᵀP + PA_2 + ½(Pb − c)(Pb − c)ᵀ + εI = 0` both Lyapunov inequalities hold; `ε` is lowered until the
/// Riccati equation has a solution that `proof` accepts.
pub(crate) fn first_proved<T>(
    claim: &str,
    slow: &DMatrix<f64>,
    (b, c): (&DVector<f64>, &DVector<f64>),
    proof: impl Fn(RationalMatrix) -> Result<T, Refutation>,
) -> Result<T, Refutation> {
    let n = slow.nrows();
    let shifted = slow - b * c.transpose() * 0.5;
    let mut last = refuse(claim, "the Riccati equation has a solution", 0.0, 1.0);
    for step in 1..12 {
        let margin = DMatrix::identity(n, n) * 10.0_f64.powi(-step);
        let q = c * c.transpose() * 0.5 + margin;
        let Some(p) = riccati::solve(&shifted, &(b * b.transpose() * 0.5), &q) else { continue };
        match proof(p.row_iter().map(|row| row.iter().copied().collect()).collect()) {
            Ok(found) => return Ok(found),
            Err(why) => last = why,
        }
    }
    Err(last)
}

/// The widest ratio, up to `highest`, for which `find` finds something, to a part in a thousand.
pub(crate) fn widest<T>(
    highest: f64,
    find: impl Fn(f64) -> Result<T, Refutation>,
) -> Result<T, Refutation> {
    if let Ok(found) = find(highest) {
        return Ok(found);
    }
    let mut best = find(1.0 + 1e-6)?;
    let (mut low, mut high) = (1.0_f64, highest);
    for _ in 0..40 {
        if high / low < 1.001 {
            break;
        }
        let middle = (low * high).sqrt();
        match find(middle) {
            Ok(found) => {
                best = found;
                low = middle;
            }
            Err(_) => high = middle,
        }
    }
    Ok(best)
}
