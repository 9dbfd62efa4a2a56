//! Sums over the loop's whole future, with a bound on what is left out.

use crate::portable;
use nalgebra::{DMatrix, DVector, DVectorView, RowDVector};
use phihat_certificate::extremes::{Extremes as _, larger};

use super::state_matrix::{Reaction, StateMatrix};

/// Powers are taken until this is left of the largest state.
const LEFT: f64 = 1e-12;

/// Longest horizon is `2^DOUBLINGS` samples.
const DOUBLINGS: u32 = 21;

/// After how many samples the loop has forgotten, and what is left then: `‖A^samples‖_∞ = left < 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Horizon {
    pub(crate) samples: usize,
    left: f64,
}

impl Horizon {
    /// `None` when the loop does not forget.
    pub(crate) fn of(a: &DMatrix<f64>) -> Option<Self> {
        let mut power = a.clone();
        for doublings in 0..=DOUBLINGS {
            let left = norm_inf(&power);
            if !left.is_finite() {
                return None;
            }
            if left < LEFT {
                return Some(Self { samples: 1 << doublings, left });
            }
            power = portable::product(&power, &power);
        }
        None
    }

    /// Given `Σ_{j<N} ‖c A^j‖₁`, bounds `Σ_{j≥N} |c A^j b|` for `‖b‖_∞ ≤ size`.
    pub(crate) fn tail(&self, rows: f64, size: f64) -> f64 {
        rows * size * self.left / (1.0 - self.left)
    }
}

/// A row `c A^j`, as a column.
pub(crate) type OutputRow<'a> = DVectorView<'a, f64>;

/// Shows `c A^j` and `c A^(j+1)` for `j = 0 … N−1`; gives `Σ ‖c A^j‖₁`.
pub(crate) fn sweep(
    a: &DMatrix<f64>,
    row: &DVector<f64>,
    horizon: Horizon,
    mut visit: impl FnMut(&OutputRow<'_>, &OutputRow<'_>),
) -> f64 {
    match a.nrows() {
        0..=8 => Padded::<8>::of(a).sweep(row, horizon, visit),
        9..=16 => Padded::<16>::of(a).sweep(row, horizon, visit),
        17..=32 => Padded::<32>::of(a).sweep(row, horizon, visit),
        // Longest delay, estimator and drive make fewer; should there be more, by the package.
        _ => {
            let (mut now, mut total) = (row.clone(), 0.0);
            let mut next = now.clone();
            for _ in 0..horizon.samples {
                next.gemv_tr(1.0, a, &now, 0.0);
                visit(&now.as_view(), &next.as_view());
                total += now.iter().map(|v| v.abs()).sum::<f64>();
                core::mem::swap(&mut now, &mut next);
            }
            total
        }
    }
}

/// Number of products that the package sums in lockstep.
const SIDE: usize = 8;

/// A matrix whose rows fill vector registers, `W` a multiple of eight.
struct Padded<const W: usize> {
    rows: Vec<Aligned<W>>,
}

/// Numbers that begin where a register's do.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Aligned<const W: usize>([f64; W]);

impl<const W: usize> Padded<W> {
    fn of(a: &DMatrix<f64>) -> Self {
        let at = |i: usize, j: usize| if j < a.ncols() { a[(i, j)] } else { 0.0 };
        let rows = (0..a.nrows()).map(|i| Aligned(core::array::from_fn(|j| at(i, j))));
        Self { rows: rows.collect() }
    }

    /// `c A`, every sum in the order in which the package has it: eight sums side by side, then what is left.
    #[inline]
    fn times(&self, c: &Aligned<W>) -> Aligned<W> {
        let product = |i: usize, sums: &mut [f64; W]| {
            for (sum, entry) in sums.iter_mut().zip(&self.rows[i].0) {
                *sum += c.0[i] * entry;
            }
        };
        let n = self.rows.len();
        let whole = n - n % SIDE;
        let mut out = [0.0; W];
        if whole > 0 {
            let mut side = [[0.0; W]; SIDE];
            for i in 0..whole {
                product(i, &mut side[i % SIDE]);
            }
            let (first, second) = side.split_at(SIDE / 2);
            for (first, second) in first.iter().zip(second) {
                for j in 0..W {
                    out[j] += first[j] + second[j];
                }
            }
        }
        for i in whole..n {
            product(i, &mut out);
        }
        Aligned(out)
    }

    fn sweep(
        &self,
        row: &DVector<f64>,
        horizon: Horizon,
        mut visit: impl FnMut(&OutputRow<'_>, &OutputRow<'_>),
    ) -> f64 {
        let n = self.rows.len();
        let seen = |row: &Aligned<W>| -> f64 { row.0[..n].iter().map(|v| v.abs()).sum() };
        let mut now = Aligned(core::array::from_fn(|i| if i < n { row[i] } else { 0.0 }));
        let mut total = 0.0;
        for _ in 0..horizon.samples {
            let next = self.times(&now);
            visit(&OutputRow::from_slice(&now.0, n), &OutputRow::from_slice(&next.0, n));
            total += seen(&now);
            now = next;
        }
        total
    }
}

/// Torque (in units of `M̄`) after a unit impulse of an input: `h_0, h_1, …`, and a bound on the rest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SampledResponse {
    pub(crate) samples: Vec<f64>,
    /// Bounds `Σ |h_k|` beyond the samples.
    pub(crate) tail: f64,
}

impl SampledResponse {
    /// `None` when the loop is unstable.
    pub(crate) fn of(matrix: &StateMatrix, reaction: &Reaction) -> Option<Self> {
        let horizon = Horizon::of(matrix.matrix())?;
        let mut samples = vec![reaction.direct];
        let row = column(&reaction.state);
        let rows = sweep(matrix.matrix(), &row, horizon, |row, _| {
            samples.push(row.dot(&reaction.drives));
        });
        Some(Self { samples, tail: horizon.tail(rows, reaction.drives.amax()) })
    }

    /// `h_k − h_{k−1}`: what the torque changes by.
    pub(crate) fn changes(&self) -> Self {
        let mut last = 0.0;
        let change = |h: &f64| h - core::mem::replace(&mut last, *h);
        Self { samples: self.samples.iter().map(change).collect(), tail: 2.0 * self.tail }
    }

    /// At most `Σ |h_k|`: the largest output for inputs of size 1.
    pub(crate) fn sum(&self) -> f64 {
        self.samples.iter().map(|h| h.abs()).sum::<f64>() + self.tail
    }

    /// At most `√(Σ h_k²)`: the rms of the output for white input of rms 1.
    pub(crate) fn root_of_squares(&self) -> f64 {
        self.samples.iter().map(|h| h * h).sum::<f64>().sqrt() + self.tail
    }

    /// At most the largest `|h_k|`.
    pub(crate) fn peak(&self) -> f64 {
        larger(self.tail, self.samples.iter().map(|h| h.abs()).largest())
    }

    /// At most the largest `|h_0 + … + h_k|`: the peak after a unit step.
    pub(crate) fn step_peak(&self) -> f64 {
        let mut sum = 0.0_f64;
        let worst = self.samples.iter().fold(0.0_f64, |worst, h| {
            sum += h;
            larger(worst, sum.abs())
        });
        worst + self.tail
    }
}

pub(crate) fn column(row: &RowDVector<f64>) -> DVector<f64> {
    row.transpose()
}

fn norm_inf(a: &DMatrix<f64>) -> f64 {
    a.row_iter().map(|row| row.iter().map(|v| v.abs()).sum()).largest()
}

/// `count` ratios from `low` to `high`, logarithmically even.
pub(crate) fn ratios(low: f64, high: f64, count: u32) -> impl Iterator<Item = f64> {
    let last = f64::from(count.max(2) - 1);
    (0..count.max(2)).map(move |k| low * libm::pow(high / low, f64::from(k) / last))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(row: &OutputRow<'_>) -> Vec<u64> {
        row.iter().map(|v| v.to_bits()).collect()
    }

    /// Against the package's own product, for loops of every size that has a way of its own.
    #[test]
    fn rows_have_the_bits_of_the_packages_products() {
        let mut seed = 1_u32;
        let mut drawn = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed) / f64::from(u32::MAX) - 0.5
        };
        for n in 1..=35 {
            let a = DMatrix::from_fn(n, n, |_, _| drawn());
            let mut row = DVector::from_fn(n, |_, _| drawn());
            let (mut expected, mut size) = (row.clone(), 0.0);
            let horizon = Horizon { samples: 6, left: 0.0 };
            let total = sweep(&a, &row.clone(), horizon, |now, next| {
                assert_eq!(bits(now), bits(&row.as_view()), "{n}");
                size += row.iter().map(|v| v.abs()).sum::<f64>();
                expected.gemv_tr(1.0, &a, &row, 0.0);
                assert_eq!(bits(next), bits(&expected.as_view()), "{n}");
                row.copy_from(&expected);
            });
            assert_eq!(total.to_bits(), size.to_bits(), "{n}");
        }
    }
}
