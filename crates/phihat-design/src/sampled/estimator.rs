//! The coefficients with which the core runs the estimator.

use phihat::{Form, ORDER_MAX};

use crate::JointRecord;

/// `α_0 … α_{m−1}` of the sampled estimator, `α_i` in \[1/s^(m−i)\]; no numbers of gains that the core refuses.
pub(crate) fn estimator_coefficients(record: &JointRecord, period: f64) -> Vec<f64> {
    let gains = record.core_gains(Form::Observer, period).ok();
    let numbers = gains.and_then(|gains| gains.observer());
    // The core has α_{m−1} first.
    let alpha = numbers.map_or([f64::NAN; ORDER_MAX], |numbers| numbers.alpha);
    let mut own: Vec<f64> = alpha.into_iter().take(record.a.len()).collect();
    own.reverse();
    own
}
