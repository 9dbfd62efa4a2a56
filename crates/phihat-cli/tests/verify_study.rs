//! A gains file against its study. Wrong if a tube that was shrunk with all that follows from it passed, or
//! if an honest one were refused.

use std::fs;

use crate::support::{folder, phihat};
use serde_json::{Value, json};

const STUDY: &str = r#"duration_s = 1.0
[robot]
name = "planar3r"
locked = { joint3 = 0.5 }
[spec]
settle_s = 0.5
error_bound_rad = 4e-3
[design]
payload_max_kg = 0.2
orders = [1]
[loop]
form = "observer"
rate_hz = 500.0
delay_samples = 1
[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 100.0
[world]
friction = "none"
coulomb_extra_nm = 0.1
substeps = 4
payload = { mass_kg = 0.2 }
[reference]
kind = "sines"
center_rad = [0.3, 0.8]
fade_in_s = 0.3
[[reference.sine]]
amplitude_rad = [0.2, 0.15]
frequency_hz = [1.0, 1.5]
phase_rad = [0.7, 0.2]
"#;

/// All bins and what is said of them, nearer to zero.
fn shrunk(gains: &Value, by: f64) -> Value {
    let mut gains = gains.clone();
    for joint in gains["certificate"]["tube"]["joints"].as_array_mut().unwrap() {
        for (_, value) in joint.as_object_mut().unwrap() {
            match value {
                Value::Number(x) => *value = json!(by * x.as_f64().unwrap()),
                Value::Array(list) => {
                    for x in list.iter_mut() {
                        *x = json!(by * x.as_f64().unwrap());
                    }
                }
                _ => {}
            }
        }
    }
    // What is said of the tip follows from the joints.
    let tip = &mut gains["certificate"]["tube"]["tip"];
    for key in ["error_bound_m", "angle_max_rad"] {
        tip[key] = json!(by * tip[key].as_f64().unwrap());
    }
    gains
}

#[test]
fn a_shrunk_tube_agrees_with_itself_and_is_refused_by_its_study() {
    let folder = folder("verify-study");
    fs::write(folder.join("two.toml"), STUDY).unwrap();
    let answer = phihat(&folder, &["design", "two.toml", "--out", "two.json"]);
    assert_eq!(answer.code, 0, "{}{}", answer.out, answer.err);
    let honest = phihat(&folder, &["verify", "two.json", "--study", "two.toml"]);
    assert_eq!(honest.code, 0, "{}{}", honest.out, honest.err);
    for told in ["BY A SECOND DERIVATION", "claimed,", "64 worlds", "every claim holds"] {
        assert!(honest.out.contains(told), "{told}: {}", honest.out);
    }
    let figures = phihat(&folder, &["verify", "two.json", "--study", "two.toml", "--json"]);
    let figures: Value = serde_json::from_str(&figures.out).unwrap();
    let again = &figures["verified"]["tube"];
    assert!(again["on_trust"].is_null(), "{again}");
    // What design writes is the wider of both derivations, bin by bin.
    for joint in again["joints"].as_array().unwrap() {
        assert!(joint["tighter"].as_f64().unwrap() <= 1.0, "{again}");
    }
    assert_eq!(figures["runs"]["runs"], 64);
    let text = fs::read_to_string(folder.join("two.json")).unwrap();
    let gains: Value = serde_json::from_str(&text).unwrap();
    for by in [0.5, 0.8, 0.95] {
        fs::write(folder.join("less.json"), shrunk(&gains, by).to_string()).unwrap();
        let alone = phihat(&folder, &["verify", "less.json"]);
        assert_eq!(alone.code, 3, "{by}: the file agrees with itself: {}", alone.out);
        let refused = phihat(&folder, &["verify", "less.json", "--study", "two.toml"]);
        assert_eq!(refused.code, 1, "{by}: {}", refused.out);
        assert!(refused.out.starts_with("REFUSED: joint"), "{by}: {}", refused.out);
    }
}

#[test]
fn the_range_of_inertia_is_proved_over_all_postures() {
    let folder = folder("prove-range");
    fs::write(folder.join("two.toml"), STUDY).unwrap();
    let design = ["design", "two.toml", "--out", "two.json", "--prove-range", "60"];
    let answer = phihat(&folder, &design);
    assert_eq!(answer.code, 0, "{}{}", answer.out, answer.err);
    let text = fs::read_to_string(folder.join("two.json")).unwrap();
    let gains: Value = serde_json::from_str(&text).unwrap();
    let arm = &gains["certificate"]["arm"];
    let number = |value: &Value| value.as_f64().unwrap();
    let proved = &arm["searched"]["proved"];
    assert!(number(&arm["low"]) <= 1.0051 * number(&proved["low"]), "{arm}");
    assert!(number(&proved["high"]) <= 1.0051 * number(&arm["high"]), "{arm}");
    let verify = ["verify", "two.json", "--study", "two.toml", "--prove-range", "60"];
    let shown = phihat(&folder, &verify);
    assert_eq!(shown.code, 0, "{}{}", shown.out, shown.err);
    for line in [
        "RANGE OF INERTIA, BY CELLS",
        "  PROVED, μ in ",
        "inside of it: stability at every posture",
    ] {
        assert!(shown.out.contains(line), "{line}: {}", shown.out);
    }
    let figures = phihat(&folder, &[&verify[..], &["--json"]].concat());
    let figures: Value = serde_json::from_str(&figures.out).unwrap();
    let range = &figures["verified"]["range"];
    assert_eq!(range["inside_window"], true, "{range}");
    assert_eq!(range["proof"]["high"], proved["high"], "the same proof: {range}");
}

#[test]
fn a_time_for_a_proof_is_a_number_above_zero() {
    let folder = folder("prove-range-time");
    fs::write(folder.join("two.toml"), STUDY).unwrap();
    for time in ["NaN", "0", "soon", "inf"] {
        let option = format!("--prove-range={time}");
        for words in [
            &["verify", "two.json", "--study", "two.toml", &option][..],
            &["design", "two.toml", "--out", "two.json", &option],
        ] {
            let answer = phihat(&folder, words);
            assert_eq!(answer.code, 2, "{words:?}: {}", answer.err);
            assert!(answer.err.contains("it must be a number above 0"), "{}", answer.err);
        }
    }
}
