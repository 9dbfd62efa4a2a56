//! The largest step of the reference that no limit has to cut.

pub use phihat_certificate::LargestStep;

use phihat_certificate::extremes::smaller;

use super::model::LoopModel;
use super::refutation::{plausible, plausible_loop, plausible_ratios, refuse};
use super::response::{SampledResponse, ratios};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "largest step";

/// Finding a [`LargestStep`].
pub trait FindStep: Sized {
    /// Finds it at `count` ratios from `low` to `high`, for a torque limit \[N·m\] and a rate limit \[N·m/s\].
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is unstable at one of them.
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        limits: (Option<f64>, Option<f64>),
        range: (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation>;
}

impl FindStep for LargestStep {
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        (torque_max, torque_rate_max): (Option<f64>, Option<f64>),
        (low, high): (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation> {
        let mut found = over(gains, model, ratios(low, high, count).collect())?;
        let by_torque = torque_max.map(|limit| limit / found.torque_per_rad_nm);
        let by_rate = torque_rate_max.map(|limit| limit * model.period_s / found.change_per_rad_nm);
        found.step_rad = by_torque.into_iter().chain(by_rate).reduce(smaller);
        Ok(found)
    }
}

fn over(gains: &JointRecord, model: &LoopModel, mu: Vec<f64>) -> Result<LargestStep, Refutation> {
    plausible(CLAIM, gains)?;
    plausible_loop(CLAIM, model)?;
    plausible_ratios(CLAIM, &mu)?;
    let (mut torque, mut change) = (0.0_f64, 0.0_f64);
    for mu in &mu {
        let matrix = StateMatrix::new(gains, model, *mu);
        let Some(response) = SampledResponse::of(&matrix, &matrix.reference()[0]) else {
            return Err(refuse(CLAIM, "A^k → 0 (stable loop), μ", *mu, 1.0));
        };
        torque = torque.max(response.step_peak());
        change = change.max(response.peak());
    }
    Ok(LargestStep {
        step_rad: None,
        torque_per_rad_nm: gains.inertia_kg_m2 * torque,
        change_per_rad_nm: gains.inertia_kg_m2 * change,
        mu,
    })
}
