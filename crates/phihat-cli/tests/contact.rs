//! Contact and payload from a study to the record. Wrong if a push is not in terminal, record and page, if the interval
//! of the payload excludes it, or if a stop could hang on a watch that there is not.

use std::fs;

use crate::support::{folder, phihat};
use serde_json::Value;

/// Three joints that are pushed upwards with 5 N from 2 s on.
const STUDY: &str = r#"
duration_s = 3.0
[robot]
name = "planar3r"
[spec]
settle_s = 1.0
error_bound_rad = 5e-3
[design]
payload_max_kg = 0.5
torque_step_max_nm = 2.0
window_margin = 1.1
[loop]
delay_samples = 1
form = "positions"
[sensor]
encoder_bits = 22
[world]
coulomb_extra_nm = 0.05
payload = { mass_kg = 0.3 }
[[world.push]]
force_n = [0.0, 0.0, 5.0]
start_s = 2.0
duration_s = 0.3
[contact]
[start]
torque_nm = "balance"
[reference]
kind = "any"
center = "ready"
box_rad = 0.4
speed_max_rad_s = 0.2
acceleration_max_rad_s2 = 0.5
jerk_max_rad_s3 = 5.0
"#;

#[test]
fn a_push_and_the_payload_are_in_terminal_record_and_page() {
    let folder = folder("contact");
    fs::write(folder.join("touched.toml"), STUDY).unwrap();
    let answer = phihat(&folder, &["run", "touched.toml", "--out", "out"]);
    assert_eq!(answer.code, 0, "{}{}", answer.out, answer.err);
    assert!(answer.out.contains("contact at t = 2.0"), "{}", answer.out);
    let run = fs::read_to_string(folder.join("out/run.json")).unwrap();
    let contact = &serde_json::from_str::<Value>(&run).unwrap()["contact"];
    let [event] = &contact["events"].as_array().unwrap()[..] else { panic!("{contact:#}") };
    let late = event["t_s"].as_f64().unwrap() - 2.0;
    assert!(late > 0.0 && late < 0.05, "{late} s");
    let force = event["force_n"][2].as_f64().unwrap();
    assert!((force - 5.0).abs() < 1.0, "{force} N");
    let [low, high] = [0, 1].map(|end| contact["payloads"][0]["mass_kg"][end].as_f64().unwrap());
    assert!(low <= 0.3 && 0.3 <= high && high - low < 0.05, "{low} … {high} kg");
    let page = fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(page.contains("contact at t = 2.0") && page.contains("payload on"));
}

#[test]
fn a_watch_without_a_bound_is_a_warning_and_no_ground_for_a_stop() {
    let folder = folder("contact-unbounded");
    let sines = "[reference]\nkind = \"hold\"\npose = \"ready\"\n";
    let gains = "[gains]\norder = 1\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 70.0\n\
                 inertia_kg_m2 = [0.42, 0.18, 0.14]\n";
    let top = "duration_s = 0.5\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 0.1\n";
    let study = |rest: &str| format!("{top}{gains}{rest}{sines}");
    fs::write(folder.join("reported.toml"), study("[contact]\n")).unwrap();
    let answer = phihat(&folder, &["run", "reported.toml", "--out", "out"]);
    let run = fs::read_to_string(folder.join("out/run.json")).unwrap();
    assert!(run.contains("contact is not watched: the gains have no bound"), "{}", answer.out);
    let stop = "[contact]\nthen = \"stop\"\n[supervisor]\n";
    fs::write(folder.join("stopped.toml"), study(stop)).unwrap();
    let answer = phihat(&folder, &["run", "stopped.toml", "--out", "other"]);
    assert_eq!(answer.code, 2, "{}{}", answer.out, answer.err);
    assert!(answer.err.contains("contact is not watched"), "{}", answer.err);
    assert!(!folder.join("other").exists());
}
