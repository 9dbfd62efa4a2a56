//! Arithmetic on matrices of at most 6×6, written so that it can be read in one go.

use phihat_certificate::extremes::Extremes as _;

/// A small matrix, row by row.
pub type RationalMatrix = Vec<Vec<f64>>;

/// A pivot counts as positive above this share of its diagonal entry: 40 roundings, more than a 6×6
/// factorisation makes.
pub const PIVOT_SHARE: f64 = 1e-14;

/// The unit matrix.
pub fn identity(n: usize) -> RationalMatrix {
    (0..n).map(|i| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect()).collect()
}

/// `X Y`.
pub fn product(x: &RationalMatrix, y: &RationalMatrix) -> RationalMatrix {
    let columns = y.first().map_or(0, Vec::len);
    let entry = |row: &Vec<f64>, j: usize| row.iter().zip(y).map(|(a, b)| a * b[j]).sum();
    x.iter().map(|row| (0..columns).map(|j| entry(row, j)).collect()).collect()
}

/// `X v`.
pub fn apply(x: &RationalMatrix, v: &[f64]) -> Vec<f64> {
    x.iter().map(|row| dot(row, v)).collect()
}

/// `uᵀv`.
pub fn dot(u: &[f64], v: &[f64]) -> f64 {
    u.iter().zip(v).map(|(a, b)| a * b).sum()
}

/// `X + f Y`.
pub fn sum(x: &RationalMatrix, f: f64, y: &RationalMatrix) -> RationalMatrix {
    let row = |(r, s): (&Vec<f64>, &Vec<f64>)| r.iter().zip(s).map(|(a, b)| a + f * b).collect();
    x.iter().zip(y).map(row).collect()
}

/// `Xᵀ`.
pub fn transpose(x: &RationalMatrix) -> RationalMatrix {
    let columns = x.first().map_or(0, Vec::len);
    (0..columns).map(|j| x.iter().map(|row| row[j]).collect()).collect()
}

/// Entry by entry `|X|`.
pub fn absolute(x: &RationalMatrix) -> RationalMatrix {
    x.iter().map(|row| row.iter().map(|v| v.abs()).collect()).collect()
}

/// Largest absolute row sum.
pub fn norm_inf(x: &RationalMatrix) -> f64 {
    x.iter().map(|row| row.iter().map(|v| v.abs()).sum()).largest()
}

/// Square root of the sum of squares: an upper bound of the spectral norm.
pub fn norm_frobenius(x: &RationalMatrix) -> f64 {
    x.iter().flatten().map(|v| v * v).sum::<f64>().sqrt()
}

/// Returns true if the matrix is `n × n`, finite and exactly symmetric.
pub fn is_symmetric(x: &RationalMatrix, n: usize) -> bool {
    x.len() == n
        && x.iter().all(|row| row.len() == n && row.iter().all(|v| v.is_finite()))
        && (0..n).all(|i| (0..i).all(|j| x[i][j].to_bits() == x[j][i].to_bits()))
}

/// The first pivot of `X = L D Lᵀ` that is not clearly positive, as (row from 1, pivot, what it must exceed);
/// `None` means `X ≻ 0`. Reads the lower triangle.
///
/// Scaling rows and columns by a diagonal matrix changes nothing, so gains of very different size do no harm.
pub fn failing_pivot(x: &RationalMatrix) -> Option<(usize, f64, f64)> {
    failing_pivot_above(x, PIVOT_SHARE)
}

/// The first failing pivot, as [`failing_pivot`] finds it, where a pivot counts above another share of its
/// diagonal entry.
pub fn failing_pivot_above(x: &RationalMatrix, share: f64) -> Option<(usize, f64, f64)> {
    let n = x.len();
    let (mut l, mut d) = (identity(n), vec![0.0; n]);
    for j in 0..n {
        d[j] = x[j][j] - (0..j).map(|k| l[j][k] * l[j][k] * d[k]).sum::<f64>();
        let least = share * x[j][j].abs();
        // A NaN is not greater than anything.
        let positive = d[j] > least;
        if !positive {
            return Some((j + 1, d[j], least));
        }
        for i in j + 1..n {
            l[i][j] = (x[i][j] - (0..j).map(|k| l[i][k] * l[j][k] * d[k]).sum::<f64>()) / d[j];
        }
    }
    None
}

/// `e^X` for `‖X‖_∞ ≤ ½`, by the Taylor series: 18 terms leave less than 1e-21.
pub fn exponential(x: &RationalMatrix) -> RationalMatrix {
    let n = x.len();
    let (mut total, mut term) = (identity(n), identity(n));
    for k in 1..=18 {
        term = product(&term, x);
        for row in &mut term {
            for v in row {
                *v /= f64::from(k);
            }
        }
        total = sum(&total, 1.0, &term);
    }
    total
}

/// Largest `f` found by bisection for which `X − f Y ≻ 0`, with `Y ≻ 0`, less one part in a million;
/// `None` when not even `X ≻ 0`.
pub fn largest_shift(x: &RationalMatrix, y: &RationalMatrix) -> Option<f64> {
    if failing_pivot(x).is_some() {
        return None;
    }
    let ratio = |i: usize| x[i][i] / y[i][i];
    let mut high = (0..x.len()).map(ratio).least();
    let mut low = high;
    for _ in 0..1000 {
        low *= 0.1;
        if failing_pivot(&sum(x, -low, y)).is_none() {
            break;
        }
    }
    if failing_pivot(&sum(x, -low, y)).is_some() {
        return None;
    }
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        if failing_pivot(&sum(x, -middle, y)).is_none() {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low * (1.0 - 1e-6))
}
