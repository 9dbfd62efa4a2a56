//! Laws that filter their innovation, from a study to a run. Wrong if a filter were taken that is no better
//! by its tube, if any certificate of it were not checked by the other derivation, or if the core ran another
//! law than the one that is certified.

use std::fs;

use serde_json::Value;

use crate::support::{folder, phihat};

/// The small arm with 18 bits and a bound that a law from positions just keeps.
const STUDY: &str = r#"
duration_s = 4.0
seed = 1
[robot]
name = "planar3r"
[spec]
settle_s = 1.0
error_bound_rad = 6e-4
[design]
payload_max_kg = 0.3
torque_step_max_nm = 0.5
FILTER
[loop]
rate_hz = 1000.0
delay_samples = 1
form = "positions"
[sensor]
encoder_bits = 18
[world]
friction = "robot"
payload = { mass_kg = 0.15 }
[start]
torque_nm = "gravity"
[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0
[[reference.sine]]
amplitude_rad = 0.30
frequency_hz = [0.15, 0.20, 0.30]
phase_rad = [0.0, 1.0, 2.0]
"#;

#[test]
fn a_filter_is_taken_where_its_tube_is_better_and_holds_what_is_claimed() {
    let folder = folder("filter");
    let designed = |name: &str, filter: &str| -> Value {
        fs::write(folder.join(format!("{name}.toml")), STUDY.replace("FILTER", filter)).unwrap();
        let (study, gains) = (format!("{name}.toml"), format!("{name}.json"));
        let answer = phihat(&folder, &["design", &study, "--out", &gains]);
        assert_eq!(answer.code, 0, "{}{}", answer.out, answer.err);
        serde_json::from_str(&fs::read_to_string(folder.join(gains)).unwrap()).unwrap()
    };
    let plain = designed("plain", "");
    let filtered = designed("filtered", "innovation_filter = true");
    let sections = |gains: &Value, i: usize| {
        let filter = &gains["joints"][i]["observer"]["innovation_filter"];
        filter.as_array().map_or(0, Vec::len)
    };
    assert!((0..3).all(|i| sections(&plain, i) == 0));
    assert!((0..3).any(|i| sections(&filtered, i) == 2), "{}", filtered["joints"]);
    // Both keep the bound; the filter with less change of torque.
    let of = |gains: &Value, key: &str| -> f64 {
        let joints = gains["certificate"]["tube"]["joints"].as_array().unwrap();
        joints.iter().map(|joint| joint[key].as_f64().unwrap()).fold(0.0, f64::max)
    };
    let [quiet, loud] = [&filtered, &plain].map(|gains| of(gains, "torque_step_steady_max_nm"));
    assert!(quiet < 0.97 * loud, "{quiet} {loud}");
    assert!(of(&filtered, "error_bound_rad") <= 6e-4);
    let verified = phihat(&folder, &["verify", "filtered.json", "--study", "filtered.toml"]);
    assert_eq!(verified.code, 0, "{}{}", verified.out, verified.err);
    assert!(verified.out.contains("every claim holds"), "{}", verified.out);
    let run = phihat(&folder, &["run", "filtered.toml", "--gains", "filtered.json"]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    let kept = "every sample of every joint stayed inside its tube, from t = 0";
    assert!(run.out.contains(kept), "{}", run.out);
}
