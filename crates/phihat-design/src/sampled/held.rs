//! Gains of a law at one inertia with `φ` held over each sample, computed as in the limit of linear laws.

use nalgebra::{DMatrix, DVector};

use super::model::LoopModel;
use super::response::{Horizon, SampledResponse, sweep};
use super::state_matrix::StateMatrix;
use crate::JointRecord;

/// Gains of one joint's sampled loop, bounded from above, in units of `M̄`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SampledGains {
    /// From the rate of `φ/M̄` to `e`, `Σ_k |T Σ_{i≤k} e_i|` \[s³\].
    pub(crate) ramp: f64,
    /// From `φ/M̄` to `e`, `Σ|e_k|` \[s²\].
    pub(crate) jump: f64,
    /// From the encoder's error to `e` \[–\].
    pub(crate) read: f64,
    /// From the encoder's error to the change of `τ/M̄` per sample \[1/s²\].
    pub(crate) change: f64,
}

impl SampledGains {
    /// `None` where the loop is not stable, or a constant `φ` leaves an error.
    pub(crate) fn at(law: &JointRecord, model: &LoopModel, mu: f64) -> Option<Self> {
        if law.order() == 0 {
            return None;
        }
        let matrix = StateMatrix::new(law, model, mu);
        let a = matrix.matrix();
        let n = a.nrows();
        let horizon = Horizon::of(a)?;
        let mut position = DVector::zeros(n);
        position[0] = 1.0;
        // A constant φ leaves nothing, so the sum up to k is minus all that follows: −c (I − A)⁻¹ A^(k+1) b.
        let later = (DMatrix::identity(n, n) - a).transpose().lu().solve(&-&position)?;
        let sums = a.tr_mul(&later) * matrix.period();
        let sum = |row: DVector<f64>, b: &DVector<f64>| {
            let mut total = 0.0;
            let rows = sweep(a, &row, horizon, |row, _| total += row.dot(b).abs());
            total + horizon.tail(rows, b.amax())
        };
        Some(Self {
            ramp: sum(sums, matrix.disturbance()),
            jump: sum(position.clone(), matrix.disturbance()),
            read: sum(position, &matrix.encoder().drives),
            change: SampledResponse::of(&matrix, matrix.encoder())?.changes().sum(),
        })
    }
}
