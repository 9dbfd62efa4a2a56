//! The largest step of the reference that no limit has to cut.

use serde::{Deserialize, Serialize};

use crate::check::decay::{Decay, Output};
use crate::check::plausible::{self, at_most, enough};
use crate::check::sample::{Loop, Signals};
use crate::refutation::refuse;
use crate::{JointRecord, LoopModel, Refutation};

const CLAIM: &str = "largest step";

/// Largest jump of `q_d` (with `q̇_d = q̈_d = 0`) for which neither torque nor torque rate exceeds its limit.
///
/// # Claim
///
/// From rest without load, for every inertia ratio tried, `|τ_k| ≤ τ_max` and `|τ_k − τ_{k−1}| ≤ τ̇_max T` at
/// all samples after a step of at most `step_rad`: the loop stays linear, so its stability is that of
/// the inertia window. The response is linear in the step; with a load the torque left counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LargestStep {
    /// The step \[rad\]; `None`: no limit is stated.
    pub step_rad: Option<f64>,
    /// Largest |τ| after a step of 1 rad \[N·m\].
    pub torque_per_rad_nm: f64,
    /// Largest |τ_k − τ_{k−1}| after a step of 1 rad \[N·m\].
    pub change_per_rad_nm: f64,
    /// Inertia ratios tried.
    pub mu: Vec<f64>,
}

impl LargestStep {
    /// Runs the loop signal by signal from a place 1 rad off its reference: no torque and no change of it may be larger
    /// than stated, and the step times them within the limits.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the limit.
    pub fn verify(
        &self,
        gains: &JointRecord,
        model: &LoopModel,
        (torque_max, torque_rate_max): (Option<f64>, Option<f64>),
    ) -> Result<(), Refutation> {
        plausible::gains(CLAIM, gains)?;
        plausible::model(CLAIM, gains, model)?;
        plausible::ratios(CLAIM, &self.mu)?;
        for limit in torque_max.into_iter().chain(torque_rate_max) {
            at_most(CLAIM, "0 < limit", f64::MIN_POSITIVE, limit)?;
            at_most(CLAIM, "limit < ∞", limit, f64::MAX)?;
        }
        for mu in &self.mu {
            let of = Loop::new(gains, model, *mu);
            let off = Signals { q: -1.0, position: -1.0, ..Signals::REST };
            let run = Decay::of(CLAIM, &of)?.run(&of, &off);
            let rest = run.left(Output::Torque)[0];
            let (mut torque, mut change, mut last) = (rest, 2.0 * rest, 0.0_f64);
            for u in run.of(Output::Torque) {
                torque = torque.max(u.abs());
                change = change.max((u - last).abs());
                last = u;
            }
            let inertia = gains.inertia_kg_m2;
            enough(CLAIM, "|τ| per rad ≤ claimed", inertia * torque, self.torque_per_rad_nm)?;
            let found = inertia * change;
            enough(CLAIM, "|τ_k − τ_{k−1}| per rad ≤ claimed", found, self.change_per_rad_nm)?;
        }
        let stated = torque_max.or(torque_rate_max).is_some();
        let Some(step) = self.step_rad else {
            return if stated {
                Err(refuse(CLAIM, "no step stated: no limit stated", 1.0, 0.0))
            } else {
                Ok(())
            };
        };
        if !stated {
            return Err(refuse(CLAIM, "a step is stated where a limit is", step, 0.0));
        }
        at_most(CLAIM, "0 ≤ step", 0.0, step)?;
        if let Some(limit) = torque_max {
            enough(CLAIM, "|τ| ≤ τ_max", step * self.torque_per_rad_nm, limit)?;
        }
        if let Some(limit) = torque_rate_max {
            let change = step * self.change_per_rad_nm / model.period_s;
            enough(CLAIM, "|τ̇| ≤ τ̇_max", change, limit)?;
        }
        Ok(())
    }
}
