//! Check that a symmetric matrix is positive definite, with an allowance for rounding.

use crate::refutation::refuse;
use crate::{Matrix, Refutation};

/// Roundings that the matrix and its factors may have suffered, relative to a diagonal of ones.
const ROOM: f64 = 1e-12;

/// `Ok` when `X ≻ 0`, beyond rounding.
///
/// # Method
///
/// `X` scaled to a diagonal of ones, less `ROOM` on it, has a factor `R` with `RᵀR` (Cholesky, row by row).
pub(crate) fn definite(claim: &str, what: &str, x: &Matrix) -> Result<(), Refutation> {
    definite_within(claim, what, x, ROOM)
}

/// The same with another room.
pub(crate) fn definite_within(
    claim: &str,
    what: &str,
    x: &Matrix,
    room: f64,
) -> Result<(), Refutation> {
    let n = x.len();
    let mut scale = Vec::with_capacity(n);
    for (i, row) in x.iter().enumerate() {
        let own = row.get(i).copied().unwrap_or(f64::NAN);
        if !(own > 0.0 && own.is_finite()) {
            return Err(refuse(claim, what, own, 0.0));
        }
        scale.push(own.sqrt());
    }
    let mut r = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in i..n {
            let own = if i == j { 1.0 - room } else { x[j][i] / (scale[i] * scale[j]) };
            let taken: f64 = (0..i).map(|k| r[k][i] * r[k][j]).sum();
            let left = own - taken;
            if i == j {
                if left.is_nan() || left <= 0.0 {
                    return Err(refuse(claim, what, left, room));
                }
                r[i][i] = left.sqrt();
            } else {
                r[i][j] = left / r[i][i];
            }
        }
    }
    Ok(())
}
