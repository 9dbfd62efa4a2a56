//! Stability margins of the sampled loop, worst over a range of inertia.

use phihat_kernel::{Range, Unproved, delay, modulus, phase};
use serde::{Deserialize, Serialize};

use crate::check::linear;
use crate::check::plausible::{self, at_most};
use crate::refutation::refuse;
use crate::window::unproved;
use crate::{InertiaWindow, JointRecord, LoopModel, Refutation};

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
/// None is needed: [`Self::verify`] proves all of them in exact arithmetic, but that the angles of a delay are those of
/// the platform's sines, taken to be right within 1e-12.
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
    /// Proves every margin.
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
        let joint = linear::joint(CLAIM, gains, model)?;
        // Wider by a rounding than what is claimed.
        let wide = InertiaWindow {
            low: (low / self.gain_up).next_down(),
            high: (high * self.gain_down).next_up(),
            low_hz: 0.0,
            high_hz: 0.0,
        };
        wide.stable(&joint).map_err(|why| Refutation { claim: "gain margin".to_owned(), ..why })?;
        let range =
            Range::new(low, high).map_err(|_| refuse(CLAIM, "0 < low ≤ high < ∞", low, high))?;
        let of = |claim: &'static str| {
            let joint = &joint;
            move |why: Unproved| unproved(claim, joint, (low, high), why)
        };
        modulus(&joint, &range, self.modulus).map_err(of("modulus margin"))?;
        let turned = self.phase_deg.to_radians() * (1.0 + 4.0 * f64::EPSILON);
        phase(&joint, &range, turned).map_err(of("phase margin"))?;
        let samples = self.delay_s / model.period_s * (1.0 + 4.0 * f64::EPSILON);
        delay(&joint, &range, samples).map_err(of("delay margin"))
    }
}
