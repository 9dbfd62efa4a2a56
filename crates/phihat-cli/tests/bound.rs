//! A motion beside the class of motions of gains. Wrong if its maxima are not those of its formula, if a motion that is
//! outside passes or one inside is refused, if the factor that brings one inside is not the least, or if a run along it
//! leaves the bound that is derived for it alone.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::support::{folder, json, phihat};
use serde_json::Value;

/// Three joints whose robot holds their gravity.
const STUDY: &str = r#"
duration_s = 3.0
[robot]
name = "planar3r"
[profile]
name = "ideal"
adds_gravity = true
[spec]
settle_s = 1.0
error_bound_rad = 3e-3
[design]
payload_max_kg = 0.05
window_margin = 1.1
[loop]
delay_samples = 1
form = "positions"
[sensor]
encoder_bits = 19
[world]
coulomb_extra_nm = 0.05
payload = { mass_kg = 0.05 }
[supervisor]
error_stop_rad = 0.2
[reference]
kind = "any"
center = "ready"
box_rad = 0.4
speed_max_rad_s = 0.4
acceleration_max_rad_s2 = 1.0
jerk_max_rad_s3 = 10.0
"#;

/// The arm's posture `ready`, and the lowest frequency of each joint \[rad/s\].
const READY: [f64; 3] = [0.4, 1.2, 0.6];
const RATES: [f64; 3] = [0.9, 0.7, 1.1];

/// Length of the motion \[s\].
const END: f64 = 6.0;

/// `A sin⁴(πt/END) sin(ωt)` about the posture, which rests at both ends with all of its derivatives up to the third.
fn position(joint: usize, amplitude: f64, t: f64) -> f64 {
    let window = (core::f64::consts::PI * t / END).sin().powi(4);
    READY[joint] + amplitude * window * (RATES[joint] * t).sin()
}

/// Writes the motion with its times times a factor, from one sample on.
fn write(folder: &Path, name: &str, amplitude: f64, (factor, first): (f64, u32)) {
    let mut text = "t_s,joint1,joint2,joint3\n".to_owned();
    for k in first..=300 {
        let t = END * f64::from(k) / 300.0;
        let row: Vec<String> = (0..3).map(|j| position(j, amplitude, t).to_string()).collect();
        let time = factor * END * f64::from(k - first) / 300.0;
        writeln!(text, "{time},{}", row.join(",")).unwrap();
    }
    fs::write(folder.join(name), text).unwrap();
}

/// The largest speed, acceleration and jerk of a joint, by differences of the formula.
fn largest(joint: usize, amplitude: f64) -> [f64; 3] {
    let h = 1e-3;
    let mut most = [0.0_f64; 3];
    for k in 2..6000_u32 {
        let at = |by: f64| position(joint, amplitude, 1e-3 * f64::from(k) + by * h);
        let speed = (at(0.5) - at(-0.5)) / h;
        let acceleration = (at(1.0) - 2.0 * at(0.0) + at(-1.0)) / (h * h);
        let jerk = (at(1.5) - 3.0 * at(0.5) + 3.0 * at(-0.5) - at(-1.5)) / (h * h * h);
        for (most, value) in most.iter_mut().zip([speed, acceleration, jerk]) {
            *most = most.max(value.abs());
        }
    }
    most
}

fn clause<'a>(found: &'a Value, joint: usize, quantity: &str) -> &'a Value {
    let clauses = found["joints"][joint]["clauses"].as_array().unwrap();
    clauses.iter().find(|clause| clause["quantity"] == quantity).unwrap()
}

fn designed() -> std::path::PathBuf {
    let folder = folder("bound");
    fs::write(folder.join("any.toml"), STUDY).unwrap();
    let answer = phihat(&folder, &["design", "any.toml"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    folder
}

const GAINS: &str = "out/any/gains.json";

/// Inside: the maxima are those of the formula, the bounds those of the certificate, and a run keeps its own.
fn inside(folder: &Path) {
    write(folder, "slow.csv", 0.15, (1.0, 0));
    let words = ["bound", "slow.csv", "--gains", GAINS, "--study", "any.toml"];
    let plain = phihat(folder, &words);
    assert_eq!(plain.code, 0, "{}{}", plain.out, plain.err);
    assert!(plain.out.contains("INSIDE the class"), "{}", plain.out);
    let found = json(folder, &[&words[..], &["--json"]].concat());
    let class: Value =
        serde_json::from_str(&fs::read_to_string(folder.join(GAINS)).unwrap()).unwrap();
    let class = &class["certificate"]["class"];
    let number = |value: &Value| value.as_f64().unwrap();
    assert_eq!((&found["inside"], number(&found["slow_down"])), (&Value::from(true), 1.0));
    for joint in 0..3 {
        let names = ["speed", "acceleration", "jerk"];
        for (name, most) in names.into_iter().zip(largest(joint, 0.15)) {
            let value = number(&clause(&found, joint, name)["value"]);
            assert!((value / most - 1.0).abs() < 0.02, "{joint} {name}: {value} {most}");
        }
        let own = &found["joints"][joint];
        assert_eq!(own["error_bound_rad"], class["error_bound_rad"][joint]);
        let along = number(&found["along"]["error_bound_rad"][joint]);
        assert!(along < number(&own["error_bound_rad"]) && along > 0.0, "{along} {own}");
    }
    let drive = ["drive", "any.toml", "--gains", GAINS, "--reference", "slow.csv", "--csv"];
    let driven = phihat(folder, &[&drive[..], &["--out", "driven"]].concat());
    assert_eq!(driven.code, 0, "{}{}", driven.out, driven.err);
    let text = fs::read_to_string(folder.join("driven/trace.csv")).unwrap();
    let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let at = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let (joint, error, mode) = (at("joint"), at("e_rad"), at("mode"));
    let mut most = [0.0_f64; 3];
    for row in rows.filter(|row| row[mode] == "tracking") {
        let i: usize = row[joint].trim_start_matches("joint").parse().unwrap();
        most[i - 1] = most[i - 1].max(row[error].parse::<f64>().unwrap().abs());
    }
    for (i, most) in most.into_iter().enumerate() {
        let along = number(&found["along"]["error_bound_rad"][i]);
        assert!(most <= along && most > 0.02 * along, "{i}: {most} {along}");
    }
}

/// Outside by its pace: exit code 1, and the factor is the least that brings it inside.
fn slowed(folder: &Path) {
    write(folder, "fast.csv", 0.15, (0.4, 0));
    let words = ["bound", "fast.csv", "--gains", GAINS];
    let answer = phihat(folder, &words);
    assert_eq!(answer.code, 1, "{}{}", answer.out, answer.err);
    assert!(answer.out.contains("OUTSIDE the class") && answer.out.contains("times as slow"));
    let found = json(folder, &[&words[..], &["--json"]].concat());
    assert_eq!(found["joints"][0]["error_bound_rad"], Value::Null);
    let factor = found["slow_down"].as_f64().unwrap();
    assert!(factor > 1.05, "{factor}");
    for (name, by, code) in [("just.csv", 1.0 + 1e-7, 0), ("nearly.csv", 1.0 - 1e-4, 1)] {
        write(folder, name, 0.15, (0.4 * factor * by, 0));
        let words = ["bound", name, "--gains", GAINS, "--json"];
        assert_eq!(phihat(folder, &words).code, code, "{name}");
        let share = json(folder, &words)["worst"][1]["share"].as_f64().unwrap();
        assert!((share - 1.0).abs() < 1e-3, "{name}: {share}");
    }
}

#[test]
fn a_motion_is_inside_its_class_or_told_by_how_much_it_is_not() {
    let folder = designed();
    inside(&folder);
    slowed(&folder);
    // Beyond the box, and a begin in the middle of the motion: no slower run is inside.
    write(&folder, "wide.csv", 0.5, (4.0, 0));
    write(&folder, "moving.csv", 0.15, (1.0, 60));
    for (name, quantity) in [("wide.csv", "position"), ("moving.csv", "rest")] {
        let words = ["bound", name, "--gains", GAINS, "--json"];
        assert_eq!(phihat(&folder, &words).code, 1, "{name}");
        let found = json(&folder, &words);
        assert_eq!(found["slow_down"], Value::Null, "{name}");
        assert_eq!(found["worst"][1]["quantity"], quantity, "{name}: {}", found["worst"]);
    }
    // What cannot be used says where.
    fs::write(folder.join("short.csv"), "t_s,joint1,joint2\n0,0,0\n1,0,0\n").unwrap();
    let answer = phihat(&folder, &["bound", "short.csv", "--gains", GAINS]);
    assert_eq!(answer.code, 2);
    assert!(answer.err.contains("no column `joint3`"), "{}", answer.err);
    let gains = fs::read_to_string(folder.join(GAINS)).unwrap();
    let mut gains: Value = serde_json::from_str(&gains).unwrap();
    gains["certificate"] = Value::Null;
    fs::write(folder.join("bare.json"), gains.to_string()).unwrap();
    let answer = phihat(&folder, &["bound", "slow.csv", "--gains", "bare.json"]);
    assert_eq!(answer.code, 2, "{}", answer.out);
    assert!(answer.err.contains("bound no class of motions"), "{}", answer.err);
}
