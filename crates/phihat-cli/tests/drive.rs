//! `phihat drive` on the simulated arm, as a person runs it. Wrong if anything moved that a check refuses, if
//! its record were not that of `phihat run`, or if Ctrl-C left no record.

use std::fs;

use crate::support::{files_of, folder, interrupted, json, phihat, small, swing};
use serde_json::Value;

#[test]
fn nothing_moves_that_a_check_refuses() {
    let folder = folder("drive-refused");
    fs::write(folder.join("small.toml"), small("stated gains", 0.05, 10.0)).unwrap();
    let before = files_of(&folder);
    let plain = phihat(&folder, &["drive", "small.toml"]);
    assert_eq!(plain.code, 2, "{}", plain.err);
    for words in [
        "REFUSED:  certificate: these gains carry no certificate",
        "--accept certificate",
        "not asked real-time: in lock-step",
    ] {
        assert!(plain.err.contains(words), "{words}: {}", plain.err);
    }
    let told = json(&folder, &["drive", "small.toml", "--json"]);
    assert_eq!(told["exit_code"], 2);
    let state = |name: &str| {
        let checks = told["checks"].as_array().unwrap();
        checks.iter().find(|check| check["name"] == name).unwrap()["state"].clone()
    };
    assert_eq!((state("certificate"), state("window")), ("failed".into(), "passed".into()));
    for wrong in [&["--accept", "certifcate"][..], &["--on", "ur://robot"], &["--processor", "1"]] {
        let answer = phihat(&folder, &[&["drive", "small.toml"], wrong].concat());
        assert_eq!(answer.code, 2, "{wrong:?}: {}", answer.err);
    }
    assert!(files_of(&folder) == before, "something was written");
}

#[test]
fn gains_of_another_arm_are_refused_by_their_window() {
    let folder = folder("drive-window");
    fs::write(folder.join("swing.toml"), swing(1.5)).unwrap();
    assert_eq!(phihat(&folder, &["design", "swing.toml", "--out", "gains.json"]).code, 0);
    // The same joint with a heavy rotor.
    let heavy = swing(1.5).replace("[spec]", "armature_kg_m2 = 20.0\n[spec]");
    fs::write(folder.join("heavy.toml"), heavy).unwrap();
    let line = ["drive", "heavy.toml", "--gains", "gains.json"];
    let answer = phihat(&folder, &line);
    assert_eq!(answer.code, 2, "{}", answer.err);
    assert!(answer.err.contains("REFUSED:  window"), "{}", answer.err);
    assert!(!folder.join("out").exists());
    let fine = phihat(&folder, &["drive", "swing.toml", "--gains", "gains.json"]);
    assert_eq!(fine.code, 0, "{}{}", fine.out, fine.err);
    assert!(fine.out.contains("passed    certificate"), "{}", fine.out);
}

#[test]
fn its_record_is_that_of_a_run_and_says_what_drove_it() {
    let folder = folder("drive-record");
    fs::write(folder.join("swing.toml"), swing(1.5)).unwrap();
    json(&folder, &["run", "swing.toml", "--out", "run", "--json"]);
    let driven = json(
        &folder,
        &["drive", "swing.toml", "--gains", "run/gains.json", "--out", "drive", "--json"],
    );
    for name in ["trace.parquet", "metrics.json", "gains.json", "study.toml"] {
        let [a, b] = ["run", "drive"].map(|at| fs::read(folder.join(at).join(name)).unwrap());
        assert!(a == b, "{name}");
    }
    assert_eq!(
        (&driven["verdict"], &driven["drive"]["end"]),
        (&"within_spec".into(), &"complete".into())
    );
    assert_eq!(driven["drive"]["samples"], 1500);
    assert_eq!(driven["drive"]["timing"]["wake_up_late"], Value::Null);
    let kept: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("drive/drive.json")).unwrap())
            .unwrap();
    assert_eq!(kept, driven["drive"]);
    let page = fs::read_to_string(folder.join("drive/report.html")).unwrap();
    assert!(page.contains("samples lost") && page.contains("0 of 1500"));
    assert_eq!(phihat(&folder, &["verify", "--run", "drive"]).code, 0);
    // A changed drive.json is found as any other file of a record is.
    fs::write(folder.join("drive/drive.json"), "{}").unwrap();
    assert_eq!(phihat(&folder, &["verify", "--run", "drive"]).code, 2);
    // A run in its place has none.
    json(&folder, &["run", "swing.toml", "--out", "drive", "--json"]);
    assert!(!folder.join("drive/drive.json").exists());
}

#[test]
fn ctrl_c_is_a_safe_stop_that_leaves_a_record() {
    let folder = folder("drive-stopped");
    let supervised = format!("{}[supervisor]\nstart_mismatch_max_rad = 0.2\n", swing(2.0));
    fs::write(folder.join("swing.toml"), &supervised).unwrap();
    json(&folder, &["run", "swing.toml", "--out", "out", "--json"]);
    fs::copy(folder.join("out/gains.json"), folder.join("gains.json")).unwrap();
    let long = supervised.replace("duration_s = 2.0", "duration_s = 3600.0");
    fs::write(folder.join("swing.toml"), long).unwrap();
    let line = ["drive", "swing.toml", "--gains", "gains.json", "--out", "out", "--json"];
    let stopped = interrupted(&folder, &line, "out/trace.parquet");
    assert_eq!(stopped.code, 1, "{}{}", stopped.out, stopped.err);
    let told: Value = serde_json::from_str(&stopped.out).unwrap();
    assert_eq!(told["drive"]["end"], "asked");
    let samples = told["drive"]["samples"].as_u64().unwrap();
    assert!((1..3_600_000).contains(&samples), "{samples}");
    let (_, trace) = phihat_session::recorded(&folder.join("out")).unwrap();
    assert_eq!(trace.len() as u64, samples);
    assert_eq!(trace.supervision.unwrap().mode.last(), Some(&phihat::Mode::SafeStop));
    assert_eq!(phihat(&folder, &["verify", "--run", "out"]).code, 0);
}
