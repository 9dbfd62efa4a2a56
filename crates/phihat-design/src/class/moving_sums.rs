//! Derivatives of a posture's matrices, without their zeros.

use super::slopes::Slopes;
use crate::lanes::Wide;

/// The posture's matrices, those of all joints' speeds side by side: column `c n + j`.
pub(super) struct MovingSums {
    /// `∂_c M`, `2 ∂_c M − D_c`, `∂_c M − D_c`.
    pub(super) blocks: [SparseColumns; 3],
    pub(super) gravity_columns: SparseColumns,
    pub(super) mass_columns: SparseColumns,
    /// `M^{-1}`, row by row.
    pub(super) inverse: Vec<f64>,
}

impl MovingSums {
    pub(super) fn of(slopes: &Slopes, inverse: Vec<f64>) -> Self {
        let n = slopes.n;
        let mut blocks = [vec![0.0; n * n * n], vec![0.0; n * n * n], vec![0.0; n * n * n]];
        for c in 0..n {
            let coriolis = slopes.coriolis(c);
            for l in 0..n {
                for j in 0..n {
                    let (m, d) = (slopes.dm[c][l * n + j], coriolis[l * n + j]);
                    let at = (l * n + c) * n + j;
                    (blocks[0][at], blocks[1][at], blocks[2][at]) = (m, 2.0 * m - d, m - d);
                }
            }
        }
        Self {
            blocks: blocks.map(|block| SparseColumns::of(&block, n * n)),
            gravity_columns: SparseColumns::of(&slopes.gravity, n),
            mass_columns: SparseColumns::of(&slopes.mass, n),
            inverse,
        }
    }

    /// Number of joints.
    pub(super) fn joints(&self) -> usize {
        self.inverse.len().isqrt()
    }
}

/// Columns of a matrix, or of matrices side by side, without their zeros.
pub(super) struct SparseColumns(Vec<Vec<(usize, f64)>>);

impl SparseColumns {
    /// Of rows of so many columns.
    pub(super) fn of(rows: &[f64], columns: usize) -> Self {
        let column = |k: usize| -> Vec<(usize, f64)> {
            let entries = rows.iter().skip(k).step_by(columns).copied().enumerate();
            entries.filter(|(_, value)| *value != 0.0).collect()
        };
        Self((0..columns).map(column).collect())
    }

    /// `out += weight · |x · column|`, column by column.
    #[inline]
    pub(super) fn add_sizes(&self, out: &mut [Wide], weight: f64, x: impl Fn(usize) -> Wide) {
        for (out, column) in out.iter_mut().zip(&self.0) {
            if let Some(((l, first), others)) = column.split_first() {
                let mut sum = x(*l).affine(*first, 0.0);
                for (l, value) in others {
                    sum.add_scaled(*value, &x(*l));
                }
                out.add_scaled(weight, &sum.size());
            }
        }
    }
}

impl SparseColumns {
    /// `x · column`.
    #[inline]
    pub(super) fn product(&self, column: usize, x: impl Fn(usize) -> Wide) -> Wide {
        let mut sum = Wide::ZERO;
        for (l, value) in self.0.get(column).into_iter().flatten() {
            sum.add_scaled(*value, &x(*l));
        }
        sum
    }
}
