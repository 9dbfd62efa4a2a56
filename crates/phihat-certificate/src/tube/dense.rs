//! Small dense matrices, row by row.

use crate::extremes::Extremes as _;

/// `a b`, of sizes `n×m` and `m×p`.
pub(super) fn product(a: &[f64], b: &[f64], (n, m, p): (usize, usize, usize)) -> Vec<f64> {
    let mut out = vec![0.0; n * p];
    for i in 0..n {
        for k in 0..m {
            let factor = a[i * m + k];
            for j in 0..p {
                out[i * p + j] += factor * b[k * p + j];
            }
        }
    }
    out
}

/// `a x`.
pub(super) fn apply(a: &[f64], x: &[f64]) -> Vec<f64> {
    a.chunks_exact(x.len()).map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
}

/// `|a| x`.
pub(super) fn apply_sizes(a: &[f64], x: &[f64]) -> Vec<f64> {
    a.chunks_exact(x.len()).map(|row| row.iter().zip(x).map(|(a, x)| a.abs() * x).sum()).collect()
}

/// `aᵀ`, from `n×m`.
pub(super) fn transpose(a: &[f64], (n, m): (usize, usize)) -> Vec<f64> {
    let mut out = vec![0.0; n * m];
    for i in 0..n {
        for j in 0..m {
            out[j * n + i] = a[i * m + j];
        }
    }
    out
}

/// The inverse by elimination with row pivots; `None` where a pivot vanishes.
pub(super) fn inverse(a: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut left = a.to_vec();
    let mut right = vec![0.0; n * n];
    for i in 0..n {
        right[i * n + i] = 1.0;
    }
    for c in 0..n {
        let pivot =
            (c..n).max_by(|i, j| left[i * n + c].abs().total_cmp(&left[j * n + c].abs()))?;
        if left[pivot * n + c].abs() < 1e-300 || !left[pivot * n + c].is_finite() {
            return None;
        }
        for j in 0..n {
            left.swap(pivot * n + j, c * n + j);
            right.swap(pivot * n + j, c * n + j);
        }
        let factor = 1.0 / left[c * n + c];
        for j in 0..n {
            left[c * n + j] *= factor;
            right[c * n + j] *= factor;
        }
        for i in (0..n).filter(|i| *i != c) {
            let factor = left[i * n + c];
            for j in 0..n {
                left[i * n + j] -= factor * left[c * n + j];
                right[i * n + j] -= factor * right[c * n + j];
            }
        }
    }
    Some(right)
}

/// `e^{A t}`, `n×n`, by halving, Taylor and squaring.
pub(super) fn exponential(a: &[f64], t: f64, n: usize) -> Vec<f64> {
    let size = |m: &[f64]| m.chunks_exact(n).map(|r| r.iter().map(|x| x.abs()).sum()).largest();
    let mut x: Vec<f64> = a.iter().map(|a| a * t).collect();
    let mut halvings = 0;
    while size(&x) > 0.25 && halvings < 60 {
        for x in &mut x {
            *x *= 0.5;
        }
        halvings += 1;
    }
    // e^X − 1, doubled by (e^X − 1)(e^X + 1).
    let mut term = x.clone();
    let mut sum = x.clone();
    for k in 2..16_u32 {
        term = product(&term, &x, (n, n, n));
        for x in &mut term {
            *x /= f64::from(k);
        }
        sum.iter_mut().zip(&term).for_each(|(s, t)| *s += t);
    }
    for _ in 0..halvings {
        let square = product(&sum, &sum, (n, n, n));
        sum.iter_mut().zip(&square).for_each(|(s, q)| *s = 2.0 * *s + q);
    }
    for i in 0..n {
        sum[i * n + i] += 1.0;
    }
    sum
}

/// A count, from a moderate number of at least 0.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "samples of a run: far below what a count can be"
)]
pub(super) fn count(x: f64) -> usize {
    x as usize
}

/// Returns true if `a` is not below `b`; NaN is below nothing.
pub(super) fn reaches(a: f64, b: f64) -> bool {
    a.is_nan() || b.is_nan() || a >= b
}
