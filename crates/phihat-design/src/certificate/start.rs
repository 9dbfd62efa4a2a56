//! The gains an arm starts with: they have to hold for its inertia as the running ones do.

use phihat_study::Study;

use super::inside::inside;
use crate::ArmInertia;
use crate::JointRecord;
use crate::claims::Refutation;
use crate::prelude::*;
use crate::sampled::estimator::sampled_coefficients;
use crate::sampled::{InertiaWindow, LoopModel};

/// Whether the start gains' window holds the arm, where the study's supervisor starts at first order.
///
/// # Errors
///
/// The [`Refutation`] that forbids it.
pub(super) fn start_inside_window(
    study: &Study,
    record: &JointRecord,
    model: &LoopModel,
    arm: &ArmInertia,
) -> Result<(), Refutation> {
    if !study.supervisor.as_ref().is_some_and(|request| request.start_first_order) {
        return Ok(());
    }
    InertiaWindow::find(&first_order(record, model.period_s), model)
        .and_then(|window| inside(&window, arm, 1.0))
        .map_err(|why| Refutation { claim: format!("{} of the start gains", why.claim), ..why })
}

/// The gains of `JointGains::first_order`: `α = α_0^{1/m}`, which is the estimator `a = −ln(1 − αT)/T`.
fn first_order(record: &JointRecord, period: f64) -> JointRecord {
    // α_0 T^m
    let lowest = sampled_coefficients(&record.a, period).first().copied().unwrap_or(f64::NAN);
    let alpha_t = lowest.powf(1.0 / record.a.len() as f64);
    JointRecord { a: vec![-(-alpha_t).ln_1p() / period], ..record.clone() }
}
