//! Characteristic polynomials of matrices with exact entries.

use num_bigint::BigInt;

use crate::{Number, Polynomial};

/// Square matrix, row by row.
pub(crate) type Matrix = Vec<Vec<Number>>;

/// `det(z − A)`, by Faddeev and LeVerrier over the integers.
///
/// # Method
///
/// With `B = 2^s A` of integers: `M_1 = 1`, `c_k = −tr(B M_k)/k`, `M_{k+1} = B M_k + c_k`. The divisions leave no rest,
/// for the `c_k` are the coefficients of `det(λ − B)`, which are integers; that of `z^{n−k}` is `2^{−sk} c_k`.
pub(crate) fn characteristic(a: &Matrix) -> Polynomial {
    let n = a.len();
    let unit = a.iter().flatten().filter_map(Number::exponent).min().unwrap_or(0);
    // Row by row only what is not zero.
    let row = |row: &Vec<Number>| -> Vec<(usize, BigInt)> {
        let all = row.iter().enumerate().filter(|(_, entry)| !entry.is_zero());
        all.map(|(j, entry)| (j, entry.in_units(unit))).collect()
    };
    let b: Vec<Vec<(usize, BigInt)>> = a.iter().map(row).collect();
    let mut m = vec![vec![BigInt::ZERO; n]; n];
    let mut last = BigInt::from(1);
    let mut coefficients = vec![Number::from(1)];
    let mut exponent = 0;
    for k in 1..=n {
        for (i, row) in m.iter_mut().enumerate() {
            row[i] += &last;
        }
        let entry = |row: &Vec<(usize, BigInt)>, j: usize| -> BigInt {
            row.iter().map(|(k, value)| value * &m[*k][j]).sum()
        };
        m = b.iter().map(|row| (0..n).map(|j| entry(row, j)).collect()).collect();
        let trace: BigInt = m.iter().enumerate().map(|(i, row)| &row[i]).sum();
        last = -trace / k;
        exponent += unit;
        coefficients.push(Number::new(last.clone(), exponent));
    }
    coefficients.reverse();
    Polynomial::new(coefficients)
}

/// The matrices without the entries of the state that no other depends on, or that are always zero, in all of them:
/// each has one eigenvalue 0 less.
pub(crate) fn reduced(mut all: Vec<Matrix>) -> Vec<Matrix> {
    let idle = |all: &[Matrix], i: usize| {
        let row = all.iter().all(|a| a[i].iter().all(Number::is_zero));
        row || all.iter().all(|a| a.iter().all(|row| row[i].is_zero()))
    };
    loop {
        let n = all.first().map_or(0, Vec::len);
        let Some(i) = (0..n).find(|i| idle(&all, *i)) else { return all };
        for a in &mut all {
            a.remove(i);
            for row in a {
                row.remove(i);
            }
        }
    }
}
