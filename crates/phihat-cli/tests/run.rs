//! A run leaves a complete record, the same each time, and its report can be made again from it. Wrong if
//! a file were missing, half-written, or depended on anything but the study.

use std::fs;

use crate::support::{folder, json, phihat, swing};

const FILES: [&str; 6] =
    ["study.toml", "gains.json", "run.json", "metrics.json", "trace.parquet", "report.html"];

#[test]
fn a_run_leaves_its_whole_record() {
    let folder = folder("record");
    let answer = phihat(&folder, &["run", "studies/first.toml"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    assert!(answer.out.contains("joint2") && answer.out.contains("report: out/first/report.html"));
    for file in FILES {
        assert!(folder.join("out/first").join(file).is_file(), "{file}");
    }
    let figures = fs::read_dir(folder.join("out/first/figures")).unwrap().count();
    assert!(figures >= 5, "{figures} figures");
    let left = fs::read_dir(folder.join("out/first")).unwrap();
    assert!(
        left.map(|e| e.unwrap().file_name()).all(|n| !n.to_str().unwrap().ends_with(".partial"))
    );
}

#[test]
fn same_study_same_bytes_and_the_report_can_be_made_again() {
    let folder = folder("same");
    for out in ["one", "two"] {
        assert_eq!(phihat(&folder, &["run", "studies/first.toml", "--out", out]).code, 0);
    }
    let read = |out: &str, file: &str| fs::read(folder.join(out).join(file)).unwrap();
    for file in FILES {
        assert!(read("one", file) == read("two", file), "{file} differs between equal runs");
    }
    let before = read("one", "report.html");
    fs::remove_file(folder.join("one/report.html")).unwrap();
    let answer = json(&folder, &["report", "one/trace.parquet", "--json"]);
    assert_eq!(answer["report"], "one/report.html");
    assert!(read("one", "report.html") == before, "the report made again differs");
}

/// Gains are not designed twice for one study by one program, and everything else is designed anew: another
/// study, gains that somebody changed, another program, or `--fresh`.
#[test]
fn a_study_run_again_keeps_the_gains_that_were_designed_for_it() {
    let folder = folder("again");
    let study = swing(1.5);
    let own = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    own("own.toml", &study);
    let run = |more: &[&str]| {
        let answer = phihat(&folder, &[&["run", "own.toml"], more].concat());
        assert_eq!(answer.code, 0, "{}", answer.err);
        answer.err.contains("designed by the last run of this study")
    };
    let read = || FILES.map(|file| fs::read(folder.join("out/own").join(file)).unwrap());
    assert!(!run(&[]));
    let first = read();
    assert!(run(&[]) && read() == first, "kept gains leave other bytes");
    assert!(!run(&["--fresh"]) && read() == first, "designed anew, they differ");
    let gains = folder.join("out/own/gains.json");
    let kept = fs::read_to_string(&gains).unwrap();
    fs::write(&gains, kept.replacen("\"rate_hz\"", " \"rate_hz\"", 1)).unwrap();
    assert!(!run(&[]) && read() == first, "gains that somebody changed were taken");
    let origin = folder.join("out/own/run.json");
    let words = fs::read_to_string(&origin).unwrap();
    let another = words.replace(", build ", ", build 0");
    assert!(another != words);
    fs::write(&origin, another).unwrap();
    assert!(!run(&[]) && read() == first, "another program's gains were taken");
    own("own.toml", &study.replace("amplitude_rad = [0.2]", "amplitude_rad = [0.19]"));
    assert!(!run(&[]) && read() != first, "another study's gains were taken");
    assert_eq!(phihat(&folder, &["run", "own.toml", "--gains", "out/own/gains.json"]).code, 0);
    assert!(!run(&[]), "gains that were given count as designed");
    assert!(run(&[]));
}

#[test]
fn json_has_its_documented_shape() {
    let folder = folder("json");
    let answer = json(&folder, &["simulate", "studies/first.toml", "--json"]);
    assert_eq!(answer["study"], "first");
    assert_eq!(answer["folder"], "out/first");
    assert!(answer["report"].is_null() && answer["diverged"].is_null());
    let joint = &answer["metrics"]["joints"][0];
    assert_eq!(joint["name"], "joint1");
    for key in [
        "error_rms_rad",
        "error_peak_rad",
        "error_steady_max_rad",
        "error_integral_steady_max_rad_s",
        "velocity_error_steady_max_rad_s",
        "tau_max_nm",
        "tau_step_max_nm",
        "phi_max_nm",
        "phi_error_steady_max_nm",
    ] {
        assert!(joint[key].is_number(), "{key}: {joint}");
    }
    let file = fs::read_to_string(folder.join("out/first/metrics.json")).unwrap();
    let file: serde_json::Value = serde_json::from_str(&file).unwrap();
    assert_eq!(file, answer["metrics"]);
}

#[test]
fn gains_can_come_from_a_file_and_are_bound_to_their_robot() {
    let folder = folder("gains");
    assert_eq!(phihat(&folder, &["simulate", "studies/first.toml"]).code, 0);
    let given = ["simulate", "studies/first.toml", "--gains", "out/first/gains.json", "--out", "b"];
    assert_eq!(phihat(&folder, &given).code, 0);
    let trace = |out: &str| fs::read(folder.join(out).join("trace.parquet")).unwrap();
    assert!(trace("out/first") == trace("b"));
    let wrong = ["simulate", "studies/panda_hand.toml", "--gains", "out/first/gains.json"];
    let answer = phihat(&folder, &wrong);
    assert_eq!(answer.code, 2);
    assert!(answer.err.contains("joint1") && answer.err.contains("panda_joint1"), "{}", answer.err);
    assert!(!folder.join("out/panda_hand").exists());
    let text = fs::read_to_string(folder.join("out/first/gains.json")).unwrap();
    fs::write(folder.join("bad.json"), text.replace("\"kp_per_s2\": 4", "\"kp_per_s2\": -4"))
        .unwrap();
    let answer = phihat(&folder, &["simulate", "studies/first.toml", "--gains", "bad.json"]);
    assert_eq!(answer.code, 2);
    assert!(answer.err.contains("kp") && answer.err.contains("positive"), "{}", answer.err);
}

#[test]
fn out_of_spec_and_divergence_have_exit_code_one_and_still_leave_evidence() {
    let folder = folder("evidence");
    let text = fs::read_to_string(folder.join("studies/first.toml")).unwrap();
    let strict = text.replace("error_bound_rad = ", "error_bound_rad = 1e-6 # was ");
    assert!(strict != text);
    fs::write(folder.join("strict.toml"), strict).unwrap();
    let answer = phihat(&folder, &["run", "strict.toml"]);
    assert_eq!(answer.code, 1, "{}", answer.err);
    assert!(answer.out.contains("OUT OF SPEC") && answer.out.contains('!'), "{}", answer.out);
    assert!(folder.join("out/strict/report.html").is_file());

    let text = fs::read_to_string(folder.join("studies/panda_hand.toml")).unwrap();
    let wild: String = text
        .lines()
        .map(|line| if line.starts_with("inertia_kg_m2") { "inertia_kg_m2 = 20.0" } else { line })
        .map(|line| if line.starts_with("torque_rate") { "torque_max_nm = \"none\"" } else { line })
        .collect::<Vec<_>>()
        .join("\n");
    fs::write(folder.join("wild.toml"), wild).unwrap();
    let answer = phihat(&folder, &["run", "wild.toml"]);
    assert_eq!(answer.code, 2, "gains outside the window do not arm: {}", answer.out);
    assert!(
        answer.err.contains("not armed") && answer.err.contains("inertia window: "),
        "{}",
        answer.err
    );
    assert!(!answer.err.contains("window.low"), "inequalities are for who asks: {}", answer.err);
    let verbose = phihat(&folder, &["run", "wild.toml", "--verbose"]);
    assert!(verbose.err.contains("window.low"), "{}", verbose.err);
    assert!(!folder.join("out/wild").exists());
    let answer = phihat(&folder, &["run", "wild.toml", "--uncertified"]);
    assert_eq!(answer.code, 1, "{}\n{}", answer.out, answer.err);
    assert!(answer.out.contains("DIVERGED at t ="), "{}", answer.out);
    assert!(folder.join("out/wild/trace.parquet").is_file());
    let page = fs::read_to_string(folder.join("out/wild/report.html")).unwrap();
    assert!(page.contains("diverged") && page.contains("uncertified"));
}
