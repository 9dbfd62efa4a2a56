//! Changes of the loop that would make an infeasible specification feasible.

use phihat::VelocitySource;
use phihat_certificate::extremes::smaller;
use phihat_study::Study;
use serde::{Deserialize, Serialize};

use super::attempt::Attempt;
use super::error::DesignError;
use super::known::PhiOf;
use super::search::{COARSE, DesignSearch};
use crate::arm::Arm;

/// Multiples of the loop's rate that are tried, the smallest first, and the highest rate \[Hz\].
const MULTIPLES: [u64; 3] = [2, 4, 8];
const HIGHEST_HZ: f64 = 20_000.0;

/// The interface of drives that one has built oneself.
const OWN_DRIVES: &str = "ideal";

/// One change after which there are gains, all else being equal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Key that is changed in the study.
    pub key: String,
    /// Value of the key.
    pub value: f64,
    /// Order of the law that was found.
    pub order: usize,
}

/// The smallest multiple of the rate, no delay, and a velocity filter: each alone, each tried out and certified.
///
/// # Errors
///
/// [`DesignError`].
pub fn alternatives(
    study: &Study,
    arm: &Arm,
    phi: PhiOf<'_>,
) -> Result<Vec<Alternative>, DesignError> {
    let mut found = Vec::new();
    let attempt = |changed: &Study| -> Result<Option<(usize, Option<f64>)>, DesignError> {
        let gains = Attempt::of(&DesignSearch::new(changed, arm, phi)?, &COARSE)?.gains;
        Ok(gains.map(|gains| (gains.joints[0].a.len(), gains.velocity_filter_hz)))
    };
    for multiple in MULTIPLES {
        let mut changed = study.clone();
        changed.control.period_ns = study.control.period_ns / multiple;
        let rate = 1e9 / changed.control.period_ns as f64;
        let most =
            study.interface.profile.rate_max.map_or(HIGHEST_HZ, |most| smaller(most, HIGHEST_HZ));
        if rate > most || !study.control.period_ns.is_multiple_of(multiple) {
            break;
        }
        if let Some((order, _)) = attempt(&changed)? {
            found.push(Alternative { key: "loop.rate_hz".into(), value: rate, order });
            break;
        }
    }
    // The delay of a robot's interface is what it is.
    if study.control.delay_samples > 0 && study.interface.profile.name == OWN_DRIVES {
        let mut changed = study.clone();
        changed.control.delay_samples = 0;
        if let Some((order, _)) = attempt(&changed)? {
            found.push(Alternative { key: "loop.delay_samples".into(), value: 0.0, order });
        }
    }
    let differenced = study.sensor.velocity == VelocitySource::Differenced;
    if differenced && !study.sensor.velocity_filter_designed {
        let mut changed = study.clone();
        changed.sensor.velocity_filter_designed = true;
        if let Some((_, Some(exact))) = attempt(&changed)? {
            // Two digits, tried out as the study will have it.
            let unit = libm::pow(10.0, libm::log10(exact).floor() - 1.0);
            let value = (exact / unit).round() * unit;
            changed.sensor.velocity_filter_designed = false;
            changed.sensor.velocity_filter_hz = Some(value);
            if let Some((order, _)) = attempt(&changed)? {
                let key = "sensor.velocity_filter_hz".into();
                found.push(Alternative { key, value, order });
            }
        }
    }
    Ok(found)
}
