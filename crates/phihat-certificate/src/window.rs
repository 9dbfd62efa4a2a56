//! The inertia window: for which inertias the sampled loop is stable.

use serde::{Deserialize, Serialize};

/// For which ratios `μ` of true to nominal inertia one joint's sampled loop is stable.
///
/// # Claim
///
/// For every constant `μ` in `[low, high]` all poles of the loop lie inside the unit circle.
///
/// # Evidence
///
/// The two numbers; [`Self::verify`] proves them by zero exclusion, from nothing but gains and model.
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

    /// Whether `[low, high]` lies inside.
    pub fn contains(&self, low: f64, high: f64) -> bool {
        self.low <= low && low <= high && high <= self.high
    }

    /// `high/low`: the ratio of inertias the window holds.
    pub fn ratio(&self) -> f64 {
        self.high / self.low
    }
}
