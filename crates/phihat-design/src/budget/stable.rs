//! Largest speed of a law with a stable loop.

use phihat_study::Study;

use crate::JointRecord;
use crate::prelude::*;
use crate::sampled::{InertiaWindow, LoopModel};

/// Halvings of the last step, and the smallest factor.
const HALVINGS: u32 = 7;
const LEAST: f64 = 1e-3;

/// Largest factor, at most 1, on the speed of a law of observer form (`K_p f²`, `K_d f`, `a_i f^{m−i}`) with
/// which the sampled loop is stable over a range `[low, high]` of inertia ratios; `None`: there is none.
///
/// The largest of those that are tried by bisection: a law may be stable again at higher speeds.
pub fn largest_stable(
    law: &JointRecord,
    model: &LoopModel,
    (low, high): (f64, f64),
) -> Option<f64> {
    if law.observer.is_some() {
        return None;
    }
    let stable = |factor: f64| {
        InertiaWindow::find(&slower(law, factor), model)
            .is_ok_and(|window| window.contains(low, high))
    };
    if stable(1.0) {
        return Some(1.0);
    }
    // Slower, step by step, until it is stable: too slow is unstable too where the nominal inertia is far off.
    let mut unstable = 1.0;
    let mut stands = 0.9;
    while !stable(stands) {
        unstable = stands;
        stands *= 0.9;
        if stands < LEAST {
            return None;
        }
    }
    for _ in 0..HALVINGS {
        let middle = (unstable * stands).sqrt();
        if stable(middle) { stands = middle } else { unstable = middle }
    }
    Some(stands)
}

/// The law with its speed times a factor.
fn slower(law: &JointRecord, factor: f64) -> JointRecord {
    let mut powers = vec![factor; law.a.len()];
    for i in (0..law.a.len().saturating_sub(1)).rev() {
        powers[i] = powers[i + 1] * factor;
    }
    JointRecord {
        kp_per_s2: law.kp_per_s2 * factor * factor,
        kd_per_s: law.kd_per_s * factor,
        a: law.a.iter().zip(&powers).map(|(a, power)| a * power).collect(),
        ..law.clone()
    }
}

/// Rate, delay and velocity filter of a study's loop in ordinary words: "at 1000 Hz, with one sample of delay
/// and a 45 Hz filter".
pub fn loop_in_words(study: &Study) -> String {
    let rate = 1e9 / study.control.period_ns as f64;
    let delay = match study.control.delay_samples + study.sensor.delay_samples {
        0 => "without delay".to_owned(),
        1 => "with one sample of delay".to_owned(),
        several => format!("with {several} samples of delay"),
    };
    let filter = study.sensor.velocity_filter_hz.map(|hz| format!(" and a {hz} Hz filter"));
    format!("at {rate} Hz, {delay}{}", filter.unwrap_or_default())
}
