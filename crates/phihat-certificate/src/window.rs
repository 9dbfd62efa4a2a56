//! The inertia window: for which inertias the sampled loop is stable.

use core::f64::consts::TAU;

use phihat_kernel::{JointLoop, Number, Range, Unproved, decays, frozen};
use serde::{Deserialize, Serialize};

use crate::check::complex::Complex;
use crate::check::linear;
use crate::check::plausible::{self, at_most};
use crate::check::response::{CheckedResponse, on_circle};
use crate::refutation::refuse;
use crate::{JointRecord, LoopModel, Refutation};

const CLAIM: &str = "inertia window";

/// Largest relative distance of `−L` at an edge's frequency from the edge.
const EDGE: f64 = 1e-4;

/// For which ratios `μ` of true to nominal inertia one joint's sampled loop is stable.
///
/// # Claim
///
/// For every constant `μ` in `[low, high]` all poles of the loop lie inside the unit circle.
///
/// # Evidence
///
/// The two numbers; [`Self::verify`] proves them in exact arithmetic, from nothing but gains and model.
///
/// # Not claimed
///
/// Inertia that varies in time: [`super::VaryingWindow`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InertiaWindow {
    /// Smallest stable `μ`.
    pub low: f64,
    /// Largest stable `μ`.
    pub high: f64,
    /// Frequency of the oscillation at the lower edge \[Hz\].
    pub low_hz: f64,
    /// Frequency of the oscillation at the upper edge \[Hz\].
    pub high_hz: f64,
}

impl InertiaWindow {
    /// The part of the window that keeps a share: `[low·margin_low, high/margin_high]`.
    #[must_use]
    pub fn inside(&self, margin_low: f64, margin_high: f64) -> Self {
        Self { low: self.low * margin_low, high: self.high / margin_high, ..*self }
    }

    /// Returns true if `[low, high]` lies inside.
    pub fn contains(&self, low: f64, high: f64) -> bool {
        self.low <= low && low <= high && high <= self.high
    }

    /// `high/low`: the ratio of inertias the window holds.
    pub fn ratio(&self) -> f64 {
        self.high / self.low
    }
}

impl InertiaWindow {
    /// Proves the claim from gains and model alone: no root of any loop in the window lies on or outside of the unit
    /// circle, and an oscillation is where the two edges say.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the frequency at which the proof fails.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        let joint = loop_of(gains, model)?;
        self.stable(&joint)?;
        let response = CheckedResponse::of(&joint);
        for (mu, hz) in [(self.low, self.low_hz), (self.high, self.high_hz)] {
            at_most(CLAIM, "0 ≤ frequency of an edge", 0.0, hz)?;
            // An edge without a frequency is where the search ended.
            if hz.abs() > 0.0 {
                let value = response.crossing(on_circle(TAU * hz * model.period_s));
                let off = (value - Complex::new(mu, 0.0)).size() / mu;
                at_most(CLAIM, "−L at the edge's frequency is μ", off, EDGE)?;
            }
        }
        Ok(())
    }

    /// Proves that every mode, at every `μ` in `[low, high]`, decays at least as fast as `e^{−rate t}`.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the frequency at which the proof fails.
    pub fn verify_decay(
        &self,
        gains: &JointRecord,
        model: &LoopModel,
        rate: f64,
    ) -> Result<(), Refutation> {
        let joint = loop_of(gains, model)?;
        let Some(radius) = radius_of(rate, model.period_s) else {
            return Err(refuse(CLAIM, "0 ≤ rate, and not too large to be told", rate, 0.0));
        };
        self.stable(&joint.within(&radius))
    }

    /// Proves all loops of the window stable.
    pub(crate) fn stable(&self, joint: &JointLoop) -> Result<(), Refutation> {
        let Self { low, high, .. } = *self;
        let range =
            Range::new(low, high).map_err(|_| refuse(CLAIM, "0 < low ≤ high < ∞", low, high))?;
        frozen(core::slice::from_ref(joint), &range)
            .map_err(|why| unproved(CLAIM, joint, (low, high), why))
    }
}

/// A radius of at most `e^{−rate T}`, which the kernel checks; `None`: the rate is negative, or too large.
pub(crate) fn radius_of(rate: f64, period: f64) -> Option<Number> {
    let of = |value: f64| Number::of(value).filter(|_| rate >= 0.0);
    // Below e^{−rate T} by more than its rounding.
    let radius = of(libm::exp(-rate * period) * (1.0 - 4.0 * f64::EPSILON))?;
    decays(&radius, &(&of(rate)? * &of(period)?)).then_some(radius)
}

fn loop_of(gains: &JointRecord, model: &LoopModel) -> Result<JointLoop, Refutation> {
    plausible::gains(CLAIM, gains)?;
    plausible::model(CLAIM, gains, model)?;
    linear::joint(CLAIM, gains, model)
}

/// The refutation where a range of one joint's loops is not proved, with how far `−L` is from the range at the
/// frequency.
pub(crate) fn unproved(
    claim: &str,
    joint: &JointLoop,
    (low, high): (f64, f64),
    why: Unproved,
) -> Refutation {
    let what = linear::failed(&format!("N + μΔ ≠ 0 for μ in [{low}, {high}]"), why);
    let Unproved::At { theta, .. } = why else { return refuse(claim, &what, low, high) };
    let value = CheckedResponse::of(joint).crossing(on_circle(theta));
    let nearest = Complex::new(value.re.clamp(low, high), 0.0);
    refuse(claim, &what, (value - nearest).size(), 0.0)
}
