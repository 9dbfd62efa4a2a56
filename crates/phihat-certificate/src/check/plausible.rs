//! Plausibility checks of gains, loop model and inertia ratios, with which every sampled claim begins.

use phihat::Form;

use crate::refutation::refuse;
use crate::{FilterSection, JointRecord, LoopModel, PositionObserver, Refutation};

/// Highest order of an estimate from positions.
const POSITIONS_ORDER_MAX: usize = 3;

/// Longest delay that a law from positions predicts across \[samples\].
const AHEAD_MAX: u32 = 4;

/// `Err` unless `left ≤ right`; a NaN fails.
pub(crate) fn at_most(
    claim: &str,
    inequality: &str,
    left: f64,
    right: f64,
) -> Result<(), Refutation> {
    if left <= right { Ok(()) } else { Err(refuse(claim, inequality, left, right)) }
}

/// The same with room for the rounding of two ways to compute it.
pub(crate) fn enough(
    claim: &str,
    inequality: &str,
    found: f64,
    claimed: f64,
) -> Result<(), Refutation> {
    at_most(claim, inequality, found, claimed * (1.0 + 1e-8))
}

/// Gains that the core runs.
pub(crate) fn gains(claim: &str, record: &JointRecord) -> Result<(), Refutation> {
    let order = record.order();
    let most = record.observer.as_ref().map_or(phihat::ORDER_MAX, |_| POSITIONS_ORDER_MAX);
    at_most(claim, "1 ≤ m", 1.0, order as f64)?;
    at_most(claim, "m is not too large", order as f64, most as f64)?;
    if let Some(own) = &record.observer {
        observer(claim, own)?;
        at_most(claim, "no `a` beside an observer", record.a.len() as f64, 0.0)?;
    }
    let outer = [record.inertia_kg_m2, record.kp_per_s2, record.kd_per_s];
    for value in record.a.iter().chain(&outer) {
        if !value.is_finite() || *value <= 0.0 {
            return Err(refuse(claim, "0 < gain < ∞", *value, 0.0));
        }
    }
    Ok(())
}

/// An observer that the core runs.
fn observer(claim: &str, own: &PositionObserver) -> Result<(), Refutation> {
    for value in &own.correction {
        if !value.is_finite() {
            return Err(refuse(claim, "|ℓ| < ∞", *value, f64::INFINITY));
        }
    }
    let share = own.share;
    let sensible = share > 0.0 && share <= 1.0;
    Refutation::unless(claim, "0 < g ≤ 1", share, 1.0, sensible)?;
    at_most(
        claim,
        "delay of the law ≤ 4 samples",
        f64::from(own.delay_samples),
        f64::from(AHEAD_MAX),
    )?;
    let (sections, most) = (own.innovation_filter.len() as f64, phihat::SECTIONS_MAX as f64);
    at_most(claim, "sections of the innovation filter ≤ 2", sections, most)?;
    own.innovation_filter.iter().try_for_each(|section| settles(claim, section))
}

/// A section of an innovation filter that settles: both roots of `z² − (2 − c_1)z + 1 − c_1 + c_0` lie inside the unit
/// circle, by Jury's table.
fn settles(claim: &str, section: &FilterSection) -> Result<(), Refutation> {
    let FilterSection { rates: [c0, c1], weights_per_s2 } = *section;
    for value in [c0, c1].into_iter().chain(weights_per_s2) {
        let what = "|number of a filter's section| < ∞";
        Refutation::unless(claim, what, value.abs(), f64::INFINITY, value.is_finite())?;
    }
    let stable = |what: &str, low: f64, high: f64| {
        Refutation::unless(
            claim,
            &format!("a filter's section settles: {what}"),
            low,
            high,
            low < high,
        )
    };
    stable("0 < c_0", 0.0, c0)?;
    stable("c_0 < c_1", c0, c1)?;
    stable("2 c_1 < 4 + c_0", 2.0 * c1, 4.0 + c0)
}

/// A loop that can be run with these gains.
pub(crate) fn model(claim: &str, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
    let of_gains = gains.observer.is_some() == (model.form == Form::Positions);
    Refutation::unless(claim, "the loop's form is that of the gains", 0.0, 1.0, of_gains)?;
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

/// Inertia ratios that were tried.
pub(crate) fn ratios(claim: &str, mu: &[f64]) -> Result<(), Refutation> {
    at_most(claim, "1 ≤ number of inertia ratios", 1.0, mu.len() as f64)?;
    at_most(claim, "number of inertia ratios ≤ 1000", mu.len() as f64, 1000.0)?;
    for ratio in mu {
        at_most(claim, "0 < μ", f64::MIN_POSITIVE, *ratio)?;
        at_most(claim, "μ < ∞", *ratio, f64::MAX)?;
    }
    Ok(())
}
