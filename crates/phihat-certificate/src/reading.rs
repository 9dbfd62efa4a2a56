//! What the encoder's resolution does to the true error.

use serde::{Deserialize, Serialize};

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
