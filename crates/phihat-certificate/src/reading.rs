//! True error caused by the encoder's resolution.

use serde::{Deserialize, Serialize};

use crate::check::decay::{Decay, Output};
use crate::check::plausible::{self, enough};
use crate::check::sample::{Loop, Outside, Signals};
use crate::{JointRecord, LoopModel, Refutation};

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
    /// Runs the loop signal by signal after one wrong reading and sums what is seen.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the gain.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        plausible::gains(CLAIM, gains)?;
        plausible::model(CLAIM, gains, model)?;
        plausible::ratios(CLAIM, &self.mu)?;
        for mu in &self.mu {
            let of = Loop::new(gains, model, *mu);
            let misread = Outside { reading: 1.0, ..Outside::default() };
            let run = Decay::of(CLAIM, &of)?.run(&of, &of.step(&Signals::REST, &misread).0);
            enough(CLAIM, "‖e ← reading‖₁ ≤ claimed", run.sum(Output::Error), self.error)?;
            let found = run.sum(Output::Velocity);
            enough(CLAIM, "‖ė ← reading‖₁ ≤ claimed", found, self.velocity_per_s)?;
        }
        Ok(())
    }
}
