//! (T5) again: how the estimator's continuous coefficients become those that run.

use crate::extremes::Extremes as _;

/// `b_i = α_i T^{m−i}`, `i = 0 … m−1`: coefficients of `Π (w − (e^{s_i T} − 1))` in `w`, `s_i` the roots of `A_o`.
///
/// # Method
///
/// `X = e^{FT} − 1` of the companion matrix with `A_o` in its last row, time counted in `1/r`, `r` the largest
/// `a_{m−k}^{1/k}`: series of `X` at `T/2^s`, then `X ← X(X + 2)`. `b_{m−k} = (−1)^k` times the sum of the principal
/// minors of size `k`.
pub(crate) fn sampled(a: &[f64], period: f64) -> Vec<f64> {
    let m = a.len();
    let root = |(i, a): (usize, &f64)| a.abs().powf(1.0 / (m - i) as f64);
    let rate = a.iter().enumerate().map(root).largest();
    let mut f = vec![vec![0.0; m]; m];
    for i in 0..m {
        if i + 1 < m {
            f[i][i + 1] = 1.0;
        }
        f[m - 1][i] = -a[i] / (0..m - i).fold(1.0, |power, _| power * rate);
    }
    let mut halvings = 0_u32;
    let mut step = rate * period;
    while step > 0.05 && halvings < 60 {
        step *= 0.5;
        halvings += 1;
    }
    let scaled: Vec<Vec<f64>> =
        f.iter().map(|row| row.iter().map(|v| v * step).collect()).collect();
    let (mut term, mut x) = (scaled.clone(), scaled.clone());
    for k in 2..16_u8 {
        term = product(&term, &scaled, 1.0 / f64::from(k));
        add(&mut x, &term, 1.0);
    }
    for _ in 0..halvings {
        let mut next = product(&x, &x, 1.0);
        add(&mut next, &x, 2.0);
        x = next;
    }
    (0..m)
        .map(|i| {
            let k = m - i;
            if k.is_multiple_of(2) { minors(&x, k) } else { -minors(&x, k) }
        })
        .collect()
}

fn product(x: &[Vec<f64>], y: &[Vec<f64>], factor: f64) -> Vec<Vec<f64>> {
    let n = x.len();
    let entry = |i: usize, j: usize| factor * (0..n).map(|k| x[i][k] * y[k][j]).sum::<f64>();
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

fn add(x: &mut [Vec<f64>], y: &[Vec<f64>], factor: f64) {
    for (row, other) in x.iter_mut().zip(y) {
        for (entry, value) in row.iter_mut().zip(other) {
            *entry += factor * value;
        }
    }
}

/// Sum of the principal minors of size `k`, `n ≤ 4`.
fn minors(x: &[Vec<f64>], k: usize) -> f64 {
    let n = x.len();
    (0..1_usize << n)
        .filter(|set| set.count_ones() as usize == k)
        .map(|set| {
            let rows: Vec<usize> = (0..n).filter(|i| set >> i & 1 == 1).collect();
            determinant(x, &rows, &rows)
        })
        .sum()
}

/// By expansion along the first row.
fn determinant(x: &[Vec<f64>], rows: &[usize], columns: &[usize]) -> f64 {
    let Some((row, rest)) = rows.split_first() else { return 1.0 };
    let term = |(k, column): (usize, &usize)| {
        let others: Vec<usize> = columns.iter().filter(|c| *c != column).copied().collect();
        let value = x[*row][*column] * determinant(x, rest, &others);
        if k % 2 == 0 { value } else { -value }
    };
    columns.iter().enumerate().map(term).sum()
}
