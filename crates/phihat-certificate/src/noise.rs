//! Torque noise from the encoder's resolution.

use core::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::check::decay::{Decay, Output};
use crate::check::linear;
use crate::check::plausible::{self, at_most, enough};
use crate::check::response::{CheckedResponse, on_circle};
use crate::check::sample::{Loop, Outside, Signals};
use crate::{JointRecord, LoopModel, Refutation};

const CLAIM: &str = "torque noise";

/// Torque noise caused by a joint's encoder, worst over some inertia ratios.
///
/// # Law
///
/// Encoder error white and even over one quantum `Δ`, rms `Δ/√12`, through the closed loop `h` from encoder
/// to commanded torque:
///
/// ```text
/// rms τ = M̄ Δ/√12 ‖h‖₂,    rms (τ_k − τ_{k−1}) = M̄ Δ/√12 ‖h_k − h_{k−1}‖₂,
/// |τ_k − τ_{k−1}| ≤ M̄ Δ/2 ‖h_k − h_{k−1}‖₁
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
}

impl TorqueNoise {
    /// Both rms values as sums over the spectrum, the bound as a sum over the response: none may be smaller.
    ///
    /// # Method
    ///
    /// `Σ h_k² = (1/2π)∫|H(e^{jθ})|²dθ`, and the mean over `n` even points of the circle differs from it by products of
    /// samples `n` apart, of which hardly anything is left.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the figure.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        plausible::gains(CLAIM, gains)?;
        plausible::model(CLAIM, gains, model)?;
        plausible::ratios(CLAIM, &self.mu)?;
        at_most(CLAIM, "0 < quantum", f64::MIN_POSITIVE, self.quantum_rad)?;
        at_most(CLAIM, "quantum < ∞", self.quantum_rad, f64::MAX)?;
        let unit = gains.inertia_kg_m2 * self.quantum_rad;
        let response = CheckedResponse::of(&linear::joint(CLAIM, gains, model)?);
        for mu in &self.mu {
            let of = Loop::new(gains, model, *mu);
            let misread = Outside { reading: 1.0, ..Outside::default() };
            let (after, first) = of.step(&Signals::REST, &misread);
            let run = Decay::of(CLAIM, &of)?.run(&of, &after);
            let rest = run.left(Output::Torque)[0];
            let all: f64 = first.abs() + run.sum(Output::Torque);
            let least = (run.seen.len() + 2) as f64;
            let (rms, change_rms) = spectrum(&response, (*mu, gains.inertia_kg_m2), least);
            // Products of samples further apart than the run is long, on either side.
            let alias = 2.0 * all * rest;
            let share = unit / 12.0_f64.sqrt();
            enough(CLAIM, "rms τ ≤ claimed", share * (rms + alias).sqrt(), self.rms_nm)?;
            let found = share * (change_rms + 4.0 * alias).sqrt();
            enough(CLAIM, "rms (τ_k − τ_{k−1}) ≤ claimed", found, self.change_rms_nm)?;
            let mut last = first;
            let change = |u: f64| (u - core::mem::replace(&mut last, u)).abs();
            let sum = first.abs() + run.of(Output::Torque).map(change).sum::<f64>() + 2.0 * rest;
            enough(CLAIM, "|τ_k − τ_{k−1}| ≤ claimed", 0.5 * unit * sum, self.change_max_nm)?;
        }
        Ok(())
    }
}

/// Means of `|H|²` and `|(1 − 1/z)H|²`, `H` from a misreading to the torque over `M̄`, over at least `least` even
/// points of the circle.
fn spectrum(response: &CheckedResponse, (mu, inertia): (f64, f64), least: f64) -> (f64, f64) {
    let half = (0.5 * least).ceil().max(2.0);
    let (mut size, mut change) = (0.0, 0.0);
    for k in (0..u32::MAX).map(f64::from).take_while(|k| *k <= half) {
        let w = on_circle(PI * k / half);
        let h = response.reading_to_torque(w, mu) / inertia;
        // Both ends of the half circle stand once on the circle, all between twice.
        let weight = if k > 0.0 && k < half { 1.0 } else { 0.5 };
        size += weight * h * h;
        change += weight * h * h * w.size() * w.size();
    }
    (size / half, change / half)
}
