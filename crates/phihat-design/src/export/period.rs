//! The sample period of gains as the core runs them.

use super::error::ExportError;
use crate::{Gains, GainsError};

/// The period \[s\] of the core.
pub(super) fn period(gains: &Gains) -> f64 {
    period_ns(gains).map_or(f64::NAN, |ns| ns as f64 * 1e-9)
}

/// The period as the core counts it.
pub(super) fn period_ns(gains: &Gains) -> Result<u64, ExportError> {
    let period = (1e9 / gains.rate_hz).round();
    if !(1.0..=1e12).contains(&period) {
        return Err(ExportError::Gains(GainsError::Rate { found: gains.rate_hz, expected: 1e3 }));
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 1 and 1e12, a whole number"
    )]
    Ok(period as u64)
}
