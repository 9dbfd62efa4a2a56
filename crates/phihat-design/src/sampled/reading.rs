//! Effect of the encoder's resolution on the true error.

use nalgebra::DVector;
pub use phihat_certificate::ReadingError;

use super::model::LoopModel;
use super::refutation::{plausible, plausible_loop, plausible_ratios, refuse};
use super::response::{Horizon, ratios, sweep};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "reading error";

/// Finding a [`ReadingError`].
pub trait FindReadingError: Sized {
    /// Computes the gains from a wrong reading at `count` inertia ratios from `low` to `high`.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is unstable at one of them.
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        range: (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation>;
}

impl FindReadingError for ReadingError {
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation> {
        over(gains, model, ratios(low, high, count).collect())
    }
}

fn over(gains: &JointRecord, model: &LoopModel, mu: Vec<f64>) -> Result<ReadingError, Refutation> {
    plausible(CLAIM, gains)?;
    plausible_loop(CLAIM, model)?;
    plausible_ratios(CLAIM, &mu)?;
    let (mut error, mut velocity_per_s) = (0.0_f64, 0.0_f64);
    for ratio in &mu {
        let matrix = StateMatrix::new(gains, model, *ratio);
        let Some(horizon) = Horizon::of(matrix.matrix()) else {
            return Err(refuse(CLAIM, "A^k → 0 (stable loop), μ", *ratio, 1.0));
        };
        let gain = |entry: usize, unit: f64| {
            let mut row = DVector::zeros(matrix.matrix().nrows());
            row[entry] = unit;
            let drives = &matrix.encoder().drives;
            let mut sum = 0.0;
            let rows = sweep(matrix.matrix(), &row, horizon, |row, _| sum += row.dot(drives).abs());
            sum + horizon.tail(rows, drives.amax())
        };
        error = error.max(gain(0, 1.0));
        velocity_per_s = velocity_per_s.max(gain(1, matrix.unit()));
    }
    Ok(ReadingError { mu, error, velocity_per_s })
}
