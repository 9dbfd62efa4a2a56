//! Torque noise from the encoder's resolution.

use core::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::model::LoopModel;
use super::refutation::{at_most, plausible, plausible_loop, plausible_ratios, refuse};
use super::response::{Response, ratios};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "torque noise";

/// Agreement asked of a claim that is computed again.
const SAME: f64 = 1.0 + 1e-9;

/// What a joint's encoder makes of the torque, worst over some inertia ratios.
///
/// # Law
///
/// Encoder error white and even over one quantum `Δ`, rms `Δ/√12`, through the closed loop `h` from encoder
/// to commanded torque:
///
/// ```text
/// rms τ = M̄ Δ/√12 ‖h‖₂,    rms (τ_k − τ_{k−1}) = M̄ Δ/√12 ‖h_k − h_{k−1}‖₂,    |τ_k − τ_{k−1}| ≤ M̄ Δ/2 ‖h_k − h_{k−1}‖₁
/// ```
///
/// # Claim
///
/// The last one holds for any sequence of quantisation errors. The two rms values hold where successive
/// errors are uncorrelated: a joint that crosses about a quantum or more per sample.
///
/// # Not claimed
///
/// At rest an encoder may show less noise (no quantum crossed) or a limit cycle inside the bound. Ratios
/// between those tried are not proved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueNoise {
    /// Quantum of the position \[rad\].
    pub quantum_rad: f64,
    /// Inertia ratios tried.
    pub mu: Vec<f64>,
    /// rms of the torque \[N·m\].
    pub rms_nm: f64,
    /// rms of the torque's change from sample to sample \[N·m\].
    pub change_rms_nm: f64,
    /// Bound of that change \[N·m\].
    pub change_max_nm: f64,
}

impl TorqueNoise {
    /// Quantum of an encoder with `bits` per revolution \[rad\].
    pub fn quantum(bits: u32) -> f64 {
        TAU / 2.0_f64.powi(i32::try_from(bits).unwrap_or(i32::MAX))
    }

    /// Computes it at `count` ratios from `low` to `high`.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is unstable at one of them.
    pub fn find(
        gains: &JointRecord,
        model: &LoopModel,
        quantum_rad: f64,
        (low, high): (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation> {
        Self::over(gains, model, quantum_rad, ratios(low, high, count).collect())
    }

    fn over(
        gains: &JointRecord,
        model: &LoopModel,
        quantum_rad: f64,
        mu: Vec<f64>,
    ) -> Result<Self, Refutation> {
        plausible(CLAIM, gains)?;
        plausible_loop(CLAIM, model)?;
        plausible_ratios(CLAIM, &mu)?;
        let (mut rms, mut change_rms, mut change_max) = (0.0_f64, 0.0_f64, 0.0_f64);
        for mu in &mu {
            let matrix = StateMatrix::new(gains, model, *mu);
            let Some(torque) = Response::of(&matrix, matrix.encoder()) else {
                return Err(refuse(CLAIM, "A^k → 0 (stable loop), μ", *mu, 1.0));
            };
            let change = torque.changes();
            rms = rms.max(torque.root_of_squares());
            change_rms = change_rms.max(change.root_of_squares());
            change_max = change_max.max(change.sum());
        }
        let unit = gains.inertia_kg_m2 * quantum_rad;
        Ok(Self {
            quantum_rad,
            mu,
            rms_nm: unit * rms / 12.0_f64.sqrt(),
            change_rms_nm: unit * change_rms / 12.0_f64.sqrt(),
            change_max_nm: unit * change_max / 2.0,
        })
    }

    /// Sums the responses again: the figures must not be smaller than what comes out.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the figure.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        let again = Self::over(gains, model, self.quantum_rad, self.mu.clone())?;
        at_most(CLAIM, "rms τ ≤ claimed", again.rms_nm, self.rms_nm * SAME)?;
        let (found, claimed) = (again.change_rms_nm, self.change_rms_nm);
        at_most(CLAIM, "rms (τ_k − τ_{k−1}) ≤ claimed", found, claimed * SAME)?;
        let (found, claimed) = (again.change_max_nm, self.change_max_nm);
        at_most(CLAIM, "|τ_k − τ_{k−1}| ≤ claimed", found, claimed * SAME)
    }
}
