//! A key with another unit than its own is refused, and the message names the right key.
//!
//! Wrong if a number could be read in a unit that its key does not say.

use crate::support::{GOOD, read};
use phihat_study::StudyErrorKind::WrongUnit;
use serde_json::Value;

/// Keys of the good study's sections, without their unit and with it.
const KEYS: &[(&str, &str, &str)] = &[
    ("spec", "settle", "s"),
    ("spec", "error_bound", "rad"),
    ("spec", "error_integral_bound", "rad_s"),
    ("spec", "velocity_error_bound", "rad_s"),
    ("gains", "bandwidth", "rad_s"),
    ("gains", "estimator_bandwidth", "rad_s"),
    ("gains", "kp", "per_s2"),
    ("gains", "kd", "per_s"),
    ("gains", "inertia", "kg_m2"),
    ("loop", "rate", "hz"),
    ("loop", "delay", "samples"),
    ("loop", "torque_max", "nm"),
    ("loop", "torque_rate_max", "nm_s"),
    ("sensor", "velocity_filter", "hz"),
    ("world", "gravity", "m_s2"),
    ("world", "coulomb_extra", "nm"),
    ("world", "viscous_extra", "nm_s_rad"),
    ("world", "drive_bandwidth", "hz"),
    ("reference", "fade_in", "s"),
];

const UNITS: &[&str] = &[
    "deg", "deg_s", "mrad", "rev", "rpm", "ms", "us", "min", "khz", "mhz", "mnm", "ncm", "knm",
    "mm", "cm", "g", "g_cm2", "kg_mm2", "lb", "per_ms",
];

#[test]
fn no_other_unit_is_read() {
    let mut count = 0;
    for (section, stem, unit) in KEYS {
        for wrong in UNITS.iter().filter(|wrong| *wrong != unit) {
            let head = format!("[{section}]\n");
            let text = GOOD.replace(&head, &format!("{head}{stem}_{wrong} = 1\n"));
            let error = read(&text).unwrap_err();
            assert_eq!(error.kind(), WrongUnit, "{error}");
            assert_eq!(error.help(), Some(format!("write `{stem}_{unit}`").as_str()));
            assert_eq!(error.key(), format!("{section}.{stem}_{wrong}"));
            count += 1;
        }
    }
    assert!(count >= 200, "only {count} mistakes tried");
}

#[test]
fn the_keys_above_exist() {
    let schema: Value = serde_json::from_str(&phihat_study::schema()).unwrap();
    for (section, stem, unit) in KEYS {
        let key = format!("{stem}_{unit}");
        let table = &schema["properties"][section];
        let kinds = table["oneOf"].as_array().cloned().unwrap_or_else(|| vec![table.clone()]);
        assert!(kinds.iter().any(|kind| kind["properties"].get(&key).is_some()), "{section}.{key}");
    }
}
