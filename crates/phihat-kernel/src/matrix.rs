//! Characteristic polynomials and adjugates of matrices with exact entries.

use num_bigint::BigInt;

use crate::{Number, Polynomial};

/// Square matrix, row by row.
pub(crate) type ExactMatrix = Vec<Vec<Number>>;

/// `det(z − A)` and `adj(z − A)`.
pub(crate) struct Resolvent {
    /// `det(z − A)`.
    pub(crate) determinant: Polynomial,
    /// `M_1, …, M_n`: `adj(z − A) = Σ M_k z^{n−k}`.
    adjugate: Vec<ExactMatrix>,
}

impl Resolvent {
    /// By Faddeev and LeVerrier over the integers.
    ///
    /// # Method
    ///
    /// With `B = 2^{−s} A` of integers: `M_1 = 1`, `c_k = −tr(B M_k)/k`, `M_{k+1} = B M_k + c_k`. The divisions leave
    /// no rest, for the `c_k` are the coefficients of `det(λ − B)`, which are integers; that of `z^{n−k}` is
    /// `2^{sk} c_k`, and `M_k` of `A` is `2^{s(k−1)}` times that of `B`.
    pub(crate) fn of(a: &ExactMatrix) -> Self {
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
        let (mut coefficients, mut adjugate) = (vec![Number::from(1)], Vec::with_capacity(n));
        let mut exponent = 0;
        for k in 1..=n {
            for (i, row) in m.iter_mut().enumerate() {
                row[i] += &last;
            }
            let number = |entry: &BigInt| Number::new(entry.clone(), exponent);
            adjugate.push(m.iter().map(|row| row.iter().map(number).collect()).collect());
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
        Self { determinant: Polynomial::new(coefficients), adjugate }
    }

    /// `bᵀ adj(z − A) e_i`.
    fn through(&self, b: &[Number], i: usize) -> Polynomial {
        let entry = |m: &ExactMatrix| {
            let terms = b.iter().zip(m).filter(|(b, _)| !b.is_zero());
            terms.fold(Number::zero(), |sum, (b, row)| &sum + &(b * &row[i]))
        };
        Polynomial::new(self.adjugate.iter().rev().map(entry).collect())
    }

    /// `D` with `det(z − A − tB) = det(z − A) + tD` for each `t`; `None` where there is none.
    ///
    /// # Method
    ///
    /// `B = Σ e_i b_iᵀ` over its `r` rows that are not zero, and `det(z − A − tB) det(z − A)^{r−1} =
    /// det(det(z − A) − tG)` with `G_ij = b_iᵀ adj(z − A) e_j`: linear in `t` for one row always, for two where
    /// `det G = 0`. More rows are not treated.
    pub(crate) fn added(&self, rows: &ExactMatrix) -> Option<Polynomial> {
        let of: Vec<usize> =
            (0..rows.len()).filter(|i| !rows[*i].iter().all(Number::is_zero)).collect();
        let through = |i: usize, j: usize| self.through(&rows[i], j);
        if let [i, j] = of[..]
            && through(i, i).product(&through(j, j)) != through(i, j).product(&through(j, i))
        {
            return None;
        }
        let none = Polynomial::new(Vec::new());
        (of.len() <= 2).then(|| of.iter().fold(none, |sum, i| sum.minus(&through(*i, *i))))
    }
}

/// The matrices without the entries of the state that no other depends on, or that are always zero, in all of them:
/// each has one eigenvalue 0 less.
pub(crate) fn reduced(mut all: Vec<ExactMatrix>) -> Vec<ExactMatrix> {
    let idle = |all: &[ExactMatrix], i: usize| {
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
