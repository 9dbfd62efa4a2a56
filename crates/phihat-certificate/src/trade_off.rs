//! Torque noise of laws with other error bounds.

use serde::{Deserialize, Serialize};

/// One law on the front of error against torque noise; estimates of the search, a few per mille low, not certified.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TradeOff {
    /// Bound on `|e|` over the bound the study asks for, on the joint that decides.
    pub error_share: f64,
    /// Largest change of torque per sample that encoder steps cause, on the joint that decides \[N·m\].
    pub torque_noise_nm: f64,
    /// Order `m` of the estimator.
    pub order: usize,
    /// Bandwidth `ω` of the outer loop \[rad/s\].
    pub bandwidth_rad_s: f64,
    /// True if these are the gains of the document.
    pub chosen: bool,
}
