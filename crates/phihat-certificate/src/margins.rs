//! Stability margins of the sampled loop, worst over a range of inertia.

use serde::{Deserialize, Serialize};

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
    /// How much more torque: `low` over the window's lower edge.
    pub gain_up: f64,
    /// How much less torque: the window's upper edge over `high`.
    pub gain_down: f64,
    /// Phase margin \[°\].
    pub phase_deg: f64,
    /// Delay margin \[s\].
    pub delay_s: f64,
    /// Modulus margin.
    pub modulus: f64,
}
