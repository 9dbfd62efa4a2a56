//! A joint's law beside the limit of linear laws, in one reckoning.

use phihat::{Form, VelocitySource};
use phihat_certificate::JointLimit;
use phihat_certificate::extremes::Extremes as _;

use super::error::LimitError;
use super::request::LimitRequest;
use crate::certificate::RATIOS;
use crate::sampled::{LoopModel, LoopParts as _, SampledGains, ratios};
use crate::{JointRecord, Phi};

/// Compares a law with the limit at its `M̄`, and at the lightest inertia of a range `μ = low … high`, for
/// the same `φ`, the same encoder of step `quantum` \[rad\], and the torque noise that the law itself has
/// over the range.
///
/// Both sides hold `φ` over each sample and count its jump in full. The law's side is a bound from above, the
/// limit's first figure one from below, so at `M̄` their ratio is at least 1.
///
/// # Errors
///
/// [`LimitError`]: what the limit does not cover, a law that does not hold over the range, or no limit.
pub fn beside_limit(
    record: &JointRecord,
    model: &LoopModel,
    (phi, quantum): (&Phi, f64),
    (low, high): (f64, f64),
) -> Result<JointLimit, LimitError> {
    covered(model, quantum)?;
    let inertia = record.inertia_kg_m2;
    let held = |mu: f64| SampledGains::at(record, model, mu).ok_or(LimitError::Unstable { mu });
    let error = |held: &SampledGains| {
        (held.ramp * phi.rate_nm_s + held.jump * phi.jump_nm) / inertia + held.read * 0.5 * quantum
    };
    let nominal = held(1.0)?;
    let mut all = vec![nominal];
    for mu in ratios(low, high, RATIOS) {
        all.push(held(mu)?);
    }
    let change = all.iter().map(|held| held.change).largest();
    let at_ratio = |mu: f64| LimitRequest {
        inertia: mu * inertia,
        phi_rate: phi.rate_nm_s,
        phi_jump: phi.jump_nm,
        quantum,
        torque_change_max: 0.5 * quantum * inertia * change,
        delay: model.late() as usize,
        period: model.period_s,
    };
    let limit_at =
        |mu: f64| super::limit(&at_ratio(mu)).map(|found| (found.low_rad, found.high_rad));
    Ok(JointLimit {
        name: record.name.clone(),
        phi_source: phi.source.clone(),
        phi_rate_nm_s: phi.rate_nm_s,
        phi_jump_nm: phi.jump_nm,
        torque_noise_nm: at_ratio(1.0).torque_change_max,
        limit_rad: limit_at(1.0)?,
        limit_lightest_rad: limit_at(low)?,
        own_rad: error(&nominal),
        range_rad: all.iter().map(error).largest(),
    })
}

/// Checks that the limit covers laws in this loop.
fn covered(model: &LoopModel, quantum: f64) -> Result<(), LimitError> {
    let velocity = model.form != Form::Positions && model.velocity == VelocitySource::Measured;
    let beyond = [
        (model.drive_bandwidth_hz.is_some(), "a drive that lags"),
        (velocity, "a velocity that is measured"),
        (quantum <= 0.0, "an exact position"),
    ];
    let first = beyond.iter().find(|(there, _)| *there);
    first.map_or(Ok(()), |(_, what)| Err(LimitError::NotCovered { what }))
}
