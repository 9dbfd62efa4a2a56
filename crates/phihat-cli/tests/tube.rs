//! A run beside the tube of its gains, and limits that acted. Wrong if a broken promise ended in exit code 0 or in any
//! kinder words, if a tube for another study were held against a run, or if a limit acted and nobody said so.

use std::fs;
use std::path::Path;

use crate::support::{folder, json, phihat, swing};
use serde_json::{Value, json as data};

/// A tube of 20 bins: wide for half a second, then of a given half width.
fn tube(error: f64) -> Value {
    let wide = [[1.0; 5].as_slice(), &[error; 15]].concat();
    let low: Vec<f64> = wide.iter().map(|e| -e).collect();
    data!({
        "bin_s": 0.1, "duration_s": 2.0, "settle_s": 0.5, "slices": 1,
        "payload": { "frame": "tip", "mass_kg": [0.0, 0.0], "com_m": [[0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
            "gyration_m": 0.0 },
        "coulomb_nm": [[0.0], [0.0]], "quantum_rad": [2.4e-5],
        "joints": [{
            "name": "joint1", "error_low_rad": low, "error_high_rad": wide,
            "velocity_low_rad_s": vec![-10.0; 20], "velocity_high_rad_s": vec![10.0; 20],
            "error_bound_rad": error, "velocity_error_bound_rad_s": 10.0,
            "torque_max_nm": 1e3, "torque_step_nm": vec![1e3; 20], "torque_step_max_nm": 1e3,
            "torque_step_steady_max_nm": 1e3,
        }],
        "limits_silent": true,
    })
}

/// Designs the study, and puts a tube into its certificate.
fn designed(folder: &Path, tube: &Value) {
    fs::write(folder.join("swing.toml"), swing(2.0)).unwrap();
    let answer = phihat(folder, &["design", "swing.toml", "--out", "swing.json"]);
    assert_eq!(answer.code, 0, "{}{}", answer.out, answer.err);
    let path = folder.join("swing.json");
    let mut gains: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let certificate = &mut gains["certificate"];
    let left = certificate["not_counted"].as_array().unwrap();
    assert!(left.iter().all(|one| one["claims"] == "assumed"), "{certificate}");
    certificate["tube"] = tube.clone();
    certificate["settle"] = data!({ "settle_s": 0.5, "from": "tube" });
    fs::write(path, gains.to_string()).unwrap();
}

#[test]
fn promise_and_measurement_stand_side_by_side() {
    let folder = folder("tube-kept");
    designed(&folder, &tube(5e-3));
    let run = ["run", "swing.toml", "--gains", "swing.json"];
    let answer = phihat(&folder, &run);
    assert_eq!(answer.code, 0, "{}{}", answer.out, answer.err);
    assert!(answer.out.contains("every sample of every joint stayed inside its tube"));
    assert!(answer.out.contains("after the first 0.5 s"), "from the certificate: {}", answer.out);
    let figures = json(&folder, &[&run[..], &["--json"]].concat());
    assert_eq!(figures["verdict"], "within_spec");
    let kept = &figures["metrics"]["tube"];
    assert_eq!(kept["joints"][0]["error_bound_rad"], 5e-3);
    assert_eq!(
        kept["joints"][0]["error_peak_rad"],
        figures["metrics"]["joints"][0]["error_steady_max_rad"]
    );
    assert!(kept["left"].is_null() && kept["no_promise"].is_null());
    let page = fs::read_to_string(folder.join("out/swing/report.html")).unwrap();
    assert!(page.contains("Tube and measurement") && page.contains("\"band\":[["));
    fs::remove_file(folder.join("out/swing/report.html")).unwrap();
    assert_eq!(phihat(&folder, &["report", "out/swing/trace.parquet"]).code, 0);
    let again = fs::read_to_string(folder.join("out/swing/report.html")).unwrap();
    assert!(again == page, "the report made again differs");
}

#[test]
fn a_broken_promise_is_red_and_ends_with_one() {
    let folder = folder("tube-broken");
    designed(&folder, &tube(1e-6));
    let answer = phihat(&folder, &["run", "swing.toml", "--gains", "swing.json"]);
    assert_eq!(answer.code, 1, "{}", answer.out);
    for word in ["the certificate is broken: please report", "joint1 left the tube at t = 0.5 s"] {
        assert!(answer.out.contains(word), "{word}: {}", answer.out);
    }
    let page = fs::read_to_string(folder.join("out/swing/report.html")).unwrap();
    assert!(page.contains("Outside its tube:"));
    let run = ["simulate", "swing.toml", "--gains", "swing.json", "--json"];
    let figures = json(&folder, &run);
    assert_eq!(figures["verdict"], "certificate_broken");
    let left = &figures["metrics"]["tube"]["left"];
    assert_eq!((&left["joint"], &left["quantity"]), (&data!("joint1"), &data!("error")));
}

#[test]
fn a_tube_is_no_promise_for_another_study() {
    let folder = folder("tube-other");
    designed(&folder, &tube(1e-6));
    fs::write(folder.join("other.toml"), swing(2.0).replace("0.2", "0.19")).unwrap();
    let answer = phihat(&folder, &["run", "other.toml", "--gains", "swing.json"]);
    assert_eq!(answer.code, 0, "{}", answer.out);
    assert!(answer.out.contains("no promise for this run: it was made for another study"));
    assert!(answer.out.contains("after the first 1 s"), "and its settling time neither");
}

#[test]
fn a_limit_that_acts_is_told_though_the_run_is_within_spec() {
    let folder = folder("limited");
    let study = &swing(2.0)
        .replace("encoder_bits = 18", "encoder_bits = 12")
        .replace("4e-3", "0.5")
        .replace(
            "[design]\nsettling_time_s = 0.2",
            "[gains]\ninertia_kg_m2 = 1.0\nbandwidth_rad_s = \
            20.0\nestimator_bandwidth_rad_s = 40.0",
        )
        .replace("\"none\"", "200.0");
    fs::write(folder.join("slow.toml"), study).unwrap();
    let answer = phihat(&folder, &["run", "slow.toml", "--uncertified"]);
    assert_eq!(answer.code, 0, "{}{}", answer.out, answer.err);
    assert!(answer.out.contains("within spec after"), "{}", answer.out);
    assert!(answer.out.contains("BUT the torque-rate limit acted in"), "{}", answer.out);
    assert!(answer.out.contains("after t = 1 s: no certificate speaks of that"));
    let page = fs::read_to_string(folder.join("out/slow/report.html")).unwrap();
    assert!(page.contains("verdict limited") && page.contains("no certificate speaks of that"));
    let figures = json(&folder, &["simulate", "slow.toml", "--uncertified", "--json"]);
    assert_eq!(figures["verdict"], "within_spec_limited");
    let share = figures["metrics"]["joints"][0]["limited_steady_share"].as_f64().unwrap();
    let samples = figures["metrics"]["joints"][0]["rate_limited_steady_samples"].as_u64().unwrap();
    assert!(share > 0.0 && (share * 1000.0 - samples as f64).abs() < 1e-6, "{share} {samples}");
}

#[test]
fn the_record_of_a_designed_run_is_verified_as_its_gains_and_study_are() {
    let folder = folder("tube-record");
    fs::write(folder.join("swing.toml"), swing(2.0)).unwrap();
    assert_eq!(phihat(&folder, &["run", "swing.toml", "--out", "out"]).code, 0);
    let alone = phihat(&folder, &["verify", "out/gains.json", "--study", "swing.toml"]);
    let record = phihat(&folder, &["verify", "--run", "out"]);
    assert_eq!((alone.code, record.code), (0, 0), "{}{}", record.out, record.err);
    let (claims, audit) = record.out.split_once("THE RECORD AGAINST WHAT IS ASSUMED\n").unwrap();
    assert!(claims.starts_with("RECORD\n") && claims.ends_with(&alone.out), "{}", record.out);
    assert!(audit.contains("HELD: "), "{audit}");
}
