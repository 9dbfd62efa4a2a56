//! Stability margins of the sampled loop, worst over a range of inertia.

use serde::{Deserialize, Serialize};

use crate::check::exclusion::Family;
use crate::check::plausible::{self, at_most};
use crate::check::returns::Returns;
use crate::{JointRecord, LoopModel, Refutation};

const CLAIM: &str = "margins";

/// Margins of `L/μ`, each the worst over `μ` in `[low, high]`, at the point where torque meets inertia.
///
/// # Claim
///
/// For each `μ` in the range, the loop stays stable when the torque that acts is, unknown to the law,
///
/// - multiplied by anything from `1/gain_down` to `gain_up`;
/// - turned by less than `phase_deg` either way, at all frequencies;
/// - late by less than `delay_s` more (a whole number of samples is exact).
///
/// `modulus` is the smallest `|1 + L/μ|`: the inverse of the largest sensitivity.
///
/// # Evidence
///
/// [`Self::verify`] proves gain and modulus by zero exclusion. Phase and delay it searches again, four times
/// as densely: checked, not proved. The modulus alone implies a phase margin of `2 asin(modulus/2)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Margins {
    /// Smallest inertia ratio of the range.
    pub low: f64,
    /// Largest inertia ratio of the range.
    pub high: f64,
    /// Upper gain margin, for more torque: `low` over the window's lower edge.
    pub gain_up: f64,
    /// Lower gain margin, for less torque: the window's upper edge over `high`.
    pub gain_down: f64,
    /// Phase margin \[°\].
    pub phase_deg: f64,
    /// Delay margin \[s\].
    pub delay_s: f64,
    /// Modulus margin.
    pub modulus: f64,
}

impl Margins {
    /// Proves every margin: gain, modulus, phase and delay by zero exclusion, whole samples of delay by a
    /// count of roots too.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the margin.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        plausible::gains(CLAIM, gains)?;
        plausible::model(CLAIM, gains, model)?;
        let Self { low, high, .. } = *self;
        at_most(CLAIM, "1 ≤ gain margin up", 1.0, self.gain_up)?;
        at_most(CLAIM, "1 ≤ gain margin down", 1.0, self.gain_down)?;
        at_most(CLAIM, "0 ≤ modulus margin", 0.0, self.modulus)?;
        at_most(CLAIM, "modulus margin ≤ 1", self.modulus, 1.0)?;
        at_most(CLAIM, "0 ≤ phase margin", 0.0, self.phase_deg)?;
        at_most(CLAIM, "phase margin ≤ 180°", self.phase_deg, 180.0)?;
        at_most(CLAIM, "0 ≤ delay margin", 0.0, self.delay_s)?;
        let returns = Returns::new(gains, model);
        let wide =
            Family { returns: &returns, low: low / self.gain_up, high: high * self.gain_down };
        wide.stable("gain margin", (1.0, 0.0, 0))?;
        let family = Family { returns: &returns, low, high };
        family.stable("modulus margin", (1.0, self.modulus, 0))?;
        family.turns("phase margin", self.phase_deg.to_radians())?;
        let samples = self.delay_s / model.period_s;
        at_most("delay margin", "delay margin ≤ 1000 samples", samples, 1000.0)?;
        family.lags("delay margin", samples)?;
        for extra in (1..=1000_u16).take_while(|extra| f64::from(*extra) <= samples) {
            family.stable("delay margin", (1.0, 0.0, usize::from(extra)))?;
        }
        Ok(())
    }
}
