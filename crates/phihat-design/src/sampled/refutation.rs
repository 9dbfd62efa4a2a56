//! Refusals of the sampled claims.

use phihat_certificate::extremes::Extremes as _;

use super::model::LoopModel;
use crate::JointRecord;
use crate::claims::Refutation;

pub(crate) fn refuse(
    claim: &str,
    inequality: impl Into<String>,
    left: f64,
    right: f64,
) -> Refutation {
    Refutation { claim: claim.to_owned(), inequality: inequality.into(), left, right }
}

/// `Err` unless `left <= right` (a NaN fails).
pub(crate) fn at_most(
    claim: &str,
    inequality: &str,
    left: f64,
    right: f64,
) -> Result<(), Refutation> {
    if left <= right { Ok(()) } else { Err(refuse(claim, inequality, left, right)) }
}

/// Every claim starts here: an order the core runs, and numbers that are positive and finite.
pub(crate) fn plausible(claim: &str, gains: &JointRecord) -> Result<(), Refutation> {
    let order = gains.order();
    at_most(claim, "1 ≤ m", 1.0, order as f64)?;
    at_most(claim, "m ≤ 4", order as f64, phihat::ORDER_MAX as f64)?;
    if let Some(own) = &gains.observer {
        for value in own.correction.iter().chain([&own.share]) {
            if !value.is_finite() {
                return Err(refuse(claim, "|correction|, share < ∞", *value, 0.0));
            }
        }
    }
    let outer = [gains.inertia_kg_m2, gains.kp_per_s2, gains.kd_per_s];
    for value in gains.a.iter().chain(&outer) {
        if !value.is_finite() || *value <= 0.0 {
            return Err(refuse(claim, "0 < gain < ∞", *value, 0.0));
        }
    }
    Ok(())
}

/// The same for the loop model.
pub(crate) fn plausible_loop(claim: &str, model: &LoopModel) -> Result<(), Refutation> {
    let filters = model.velocity_filter_hz.into_iter().chain(model.torque_filter_hz);
    for value in filters.chain(model.drive_bandwidth_hz).chain([model.period_s]) {
        if !value.is_finite() || value <= 0.0 {
            return Err(refuse(claim, "0 < period, bandwidth < ∞", value, 0.0));
        }
    }
    for delay in [model.delay_samples, model.sample_delay_samples] {
        at_most(claim, "delay ≤ 8 samples", f64::from(delay), phihat::DELAY_MAX as f64)?;
    }
    Ok(())
}

/// The same for a list of inertia ratios.
pub(crate) fn plausible_ratios(claim: &str, mu: &[f64]) -> Result<(), Refutation> {
    at_most(claim, "1 ≤ number of inertia ratios", 1.0, mu.len() as f64)?;
    let least = mu.iter().copied().least();
    at_most(claim, "0 < μ", f64::MIN_POSITIVE, least)
}
