//! Torque noise from the encoder's resolution.

pub use phihat_certificate::TorqueNoise;

use super::model::LoopModel;
use super::refutation::{plausible, plausible_loop, plausible_ratios, refuse};
use super::response::{SampledResponse, ratios};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "torque noise";

/// Finding [`TorqueNoise`].
pub trait FindNoise: Sized {
    /// Computes the torque noise at `count` inertia ratios from `low` to `high`.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is unstable at one of them.
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        quantum_rad: f64,
        range: (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation>;
}

impl FindNoise for TorqueNoise {
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        quantum_rad: f64,
        (low, high): (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation> {
        over(gains, model, quantum_rad, ratios(low, high, count).collect())
    }
}

fn over(
    gains: &JointRecord,
    model: &LoopModel,
    quantum_rad: f64,
    mu: Vec<f64>,
) -> Result<TorqueNoise, Refutation> {
    plausible(CLAIM, gains)?;
    plausible_loop(CLAIM, model)?;
    plausible_ratios(CLAIM, &mu)?;
    let (mut rms, mut change_rms, mut change_max) = (0.0_f64, 0.0_f64, 0.0_f64);
    for mu in &mu {
        let matrix = StateMatrix::new(gains, model, *mu);
        let Some(torque) = SampledResponse::of(&matrix, matrix.encoder()) else {
            return Err(refuse(CLAIM, "A^k → 0 (stable loop), μ", *mu, 1.0));
        };
        let change = torque.changes();
        rms = rms.max(torque.root_of_squares());
        change_rms = change_rms.max(change.root_of_squares());
        change_max = change_max.max(change.sum());
    }
    let unit = gains.inertia_kg_m2 * quantum_rad;
    Ok(TorqueNoise {
        quantum_rad,
        mu,
        rms_nm: unit * rms / 12.0_f64.sqrt(),
        change_rms_nm: unit * change_rms / 12.0_f64.sqrt(),
        change_max_nm: unit * change_max / 2.0,
    })
}
