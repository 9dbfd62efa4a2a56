//! A coefficient of a least-squares fit, with the largest error by a torque that no sample exceeds.

use nalgebra::{DMatrix, DVector};
use phihat_certificate::extremes::Extremes as _;

/// Factor on the largest torque that a fit leaves unexplained: part of what it does not model may look like the column.
pub(crate) const UNEXPLAINED: f64 = 1.5;

/// Share of the largest column below which a column is a combination of the others.
const RANK: f64 = 1e-9;

/// A coefficient and its bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundedCoefficient {
    /// The estimate.
    pub value: f64,
    /// Largest error of it by a residual that is as large as the largest one, (R3) without its factor.
    pub half: f64,
    /// Largest residual.
    pub unexplained: f64,
    /// Root mean square of the part of the column that is orthogonal to the others.
    pub own_rms: f64,
}

impl BoundedCoefficient {
    /// The interval by (R3), both ends.
    pub fn interval(&self) -> (f64, f64) {
        (self.value - UNEXPLAINED * self.half, self.value + UNEXPLAINED * self.half)
    }
}

/// Every coefficient of a fit of `y` by columns of its length, with its bound.
pub fn bounded_coefficients(columns: &[Vec<f64>], y: &[f64]) -> Vec<BoundedCoefficient> {
    let all: Vec<DVector<f64>> = columns.iter().map(|x| DVector::from_column_slice(x)).collect();
    let y = DVector::from_column_slice(y);
    let one = |at: usize| {
        let mut others = all.clone();
        let own = others.swap_remove(at);
        bounded(&others, &own, &y)
    };
    (0..all.len()).map(one).collect()
}

/// The coefficient of one column beside others.
pub(crate) fn bounded(
    others: &[DVector<f64>],
    own: &DVector<f64>,
    y: &DVector<f64>,
) -> BoundedCoefficient {
    let base = basis(others);
    let (u, rest) = (orthogonal(&base, own), orthogonal(&base, y));
    let square = u.norm_squared().max(f64::MIN_POSITIVE);
    let value = u.dot(&rest) / square;
    let residual = rest - &u * value;
    let unexplained = residual.iter().map(|x| x.abs()).largest();
    let sum: f64 = u.iter().map(|x| x.abs()).sum();
    let own_rms = (square / own.len().max(1) as f64).sqrt();
    BoundedCoefficient { value, half: unexplained * sum / square, unexplained, own_rms }
}

/// An orthonormal basis of what columns span, by a QR factorisation with pivots, which reveals their rank.
pub(crate) fn basis(columns: &[DVector<f64>]) -> DMatrix<f64> {
    let scaled = |column: &DVector<f64>| column / column.norm().max(f64::MIN_POSITIVE);
    let all: Vec<DVector<f64>> = columns.iter().map(scaled).collect();
    let qr = DMatrix::from_columns(&all).col_piv_qr();
    let r = qr.r();
    let first = r[(0, 0)].abs();
    let rank = (0..r.nrows()).take_while(|k| r[(*k, *k)].abs() > RANK * first).count();
    qr.q().columns(0, rank).into_owned()
}

/// The part of a column that is orthogonal to a basis; projected twice, so that rounding leaves none of the rest.
pub(crate) fn orthogonal(basis: &DMatrix<f64>, column: &DVector<f64>) -> DVector<f64> {
    let once = column - basis * basis.tr_mul(column);
    &once - basis * basis.tr_mul(&once)
}
