//! What the encoder's resolution does to the true error.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::model::LoopModel;
use super::refutation::{at_most, plausible, plausible_loop, plausible_ratios, refuse};
use super::response::{Horizon, ratios, sweep};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "reading error";

/// Peak-to-peak gains from what the encoder reads wrong to the true `e` and `ė`, worst over inertia ratios.
///
/// # Claim
///
/// From rest, at every sample, for any sequence of reading errors `|n_k| ≤ Δ/2`:
/// `|e| ≤ error Δ/2`, `|ė| ≤ velocity Δ/2`.
///
/// # Evidence
///
/// The L1 norms of both responses with their tails bounded, computed again by [`Self::verify`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReadingError {
    /// Inertia ratios tried.
    pub mu: Vec<f64>,
    /// From reading error \[rad\] to `e` \[rad\].
    pub error: f64,
    /// From reading error \[rad\] to `ė` \[rad/s\].
    pub velocity_per_s: f64,
}

impl ReadingError {
    /// Computes the gains at `count` ratios from `low` to `high`.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is unstable at one of them.
    pub fn find(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation> {
        Self::over(gains, model, ratios(low, high, count).collect())
    }

    fn over(gains: &JointRecord, model: &LoopModel, mu: Vec<f64>) -> Result<Self, Refutation> {
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
                let rows = sweep(matrix.matrix(), row, horizon, |row| sum += row.dot(drives).abs());
                sum + horizon.tail(rows, drives.amax())
            };
            error = error.max(gain(0, 1.0));
            velocity_per_s = velocity_per_s.max(gain(1, matrix.unit()));
        }
        Ok(Self { mu, error, velocity_per_s })
    }

    /// Computes the norms again: the gains must not be smaller.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the gain.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        let again = Self::over(gains, model, self.mu.clone())?;
        let slack = 1.0 + 1e-9;
        at_most(CLAIM, "‖e ← reading‖₁ ≤ claimed", again.error, self.error * slack)?;
        let (found, claimed) = (again.velocity_per_s, self.velocity_per_s);
        at_most(CLAIM, "‖ė ← reading‖₁ ≤ claimed", found, claimed * slack)
    }
}
