//! Help examples work as typed; a bad input gives one error that says what, where and what would be valid,
//! exit code 2, and leaves the disk as it was.

use std::fs;

use crate::support::{folder, json, phihat, swing};

#[test]
fn examples_of_every_help_work_as_typed() {
    let folder = folder("help");
    let mut examples = 0;
    for verb in [
        "",
        "run",
        "design",
        "verify",
        "export",
        "simulate",
        "report",
        "robots",
        "check",
        "schema",
        "completions",
        "man",
    ] {
        let arguments: Vec<&str> = [verb, "--help"].into_iter().filter(|a| !a.is_empty()).collect();
        let help = phihat(&folder, &arguments);
        assert_eq!(help.code, 0);
        let lines = help.out.lines().skip_while(|l| !l.starts_with("Example"));
        for line in lines.filter_map(|l| l.trim().strip_prefix("phihat ")) {
            let words: Vec<&str> = line.split_whitespace().collect();
            let answer = phihat(&folder, &words);
            assert_eq!(answer.code, 0, "phihat {line}: {}", answer.err);
            examples += 1;
        }
    }
    assert!(examples >= 12, "only {examples} examples found");
}

#[test]
fn robots_are_listed_and_shown() {
    let folder = folder("robots");
    let list = json(&folder, &["robots", "--json"]);
    let names: Vec<&str> =
        list.as_array().unwrap().iter().map(|r| r["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["planar3r", "panda", "iiwa14", "ur5"]);
    let panda = json(&folder, &["robots", "panda", "--json"]);
    assert_eq!(panda["joints"].as_array().unwrap().len(), 7);
    // The eigenvalue ratio of the Panda with Franka's rotor inertias is 8.6 (found independently).
    let ratio = panda["eigenvalue_ratio"].as_f64().unwrap();
    assert!((ratio - 8.6).abs() < 0.6, "{ratio}");
    let shown = phihat(&folder, &["robots", "panda"]);
    assert!(shown.out.contains("panda_joint7") && shown.out.contains("provenance"));
}

#[test]
fn a_reader_that_has_seen_enough_ends_the_program_without_a_word() {
    let folder = folder("pipe");
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_phihat"))
        .args(["robots", "panda"])
        .current_dir(&folder)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

#[cfg(unix)]
#[test]
fn devices_pipes_and_folders_are_no_files() {
    let folder = folder("devices");
    let made = std::process::Command::new("mkfifo").arg(folder.join("fifo")).status().unwrap();
    assert!(made.success());
    std::os::unix::fs::symlink("/dev/zero", folder.join("zero.urdf")).unwrap();
    fs::create_dir(folder.join("folder.json")).unwrap();
    let study = fs::read_to_string(folder.join("studies/first.toml")).unwrap();
    let with = |file: &str| study.replace("name = \"planar3r\"", &format!("file = \"{file}\""));
    for (name, text) in [("zero.toml", with("zero.urdf")), ("fifo.toml", with("fifo"))] {
        assert!(text.contains("file = "));
        fs::write(folder.join(name), text).unwrap();
    }
    for arguments in [
        ["robots", "zero.urdf"],
        ["run", "zero.toml"],
        ["run", "fifo.toml"],
        ["verify", "fifo"],
        ["verify", "/dev/zero"],
        ["verify", "folder.json"],
        ["report", "fifo"],
        ["report", "/dev/zero"],
    ] {
        let answer = phihat(&folder, &arguments);
        assert_eq!(answer.code, 2, "{arguments:?}: {}", answer.out);
        assert!(answer.err.contains("a file is needed"), "{arguments:?}: {}", answer.err);
    }
}

#[test]
fn failures_are_documents_where_documents_are_asked_for() {
    let folder = folder("json_failures");
    let hard = swing(1.5).replace("error_bound_rad = 4e-3", "error_bound_rad = 1e-9");
    assert_ne!(hard, swing(1.5));
    fs::write(folder.join("hard.toml"), hard).unwrap();
    for (arguments, code, word) in [
        (vec!["run", "nowhere.toml", "--json"], 2, "nowhere.toml"),
        (vec!["robots", "pandaa", "--json"], 2, "panda"),
        (vec!["verify", "nowhere.json", "--json"], 2, "nowhere.json"),
        (vec!["run", "studies/first.toml", "--json", "--nonsense"], 2, "--nonsense"),
        (vec!["run", "hard.toml", "--json"], 1, "error_bound_rad"),
    ] {
        let answer = phihat(&folder, &arguments);
        let document: serde_json::Value = serde_json::from_str(&answer.out).unwrap();
        assert_eq!((answer.code, &document["exit_code"]), (code, &code.into()), "{arguments:?}");
        assert!(document["error"].as_str().unwrap().contains(word), "{arguments:?}");
    }
}

#[test]
fn a_urdf_is_read_with_the_robot_file_beside_it() {
    let folder = folder("beside");
    let robots = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../phihat-model/robots");
    for name in ["panda.urdf", "panda.toml"] {
        fs::copy(robots.join(name), folder.join(name)).unwrap();
    }
    let shown = |file: &str| json(&folder, &["robots", file, "--json"]);
    let (urdf, toml) = (shown("panda.urdf"), shown("panda.toml"));
    assert_eq!(urdf["joints"], toml["joints"]);
    assert!(urdf["joints"][0]["armature_kg_m2"].as_f64().unwrap() > 0.1);
    // A broken one is not passed over, a study of that name is.
    let text = fs::read_to_string(folder.join("panda.toml")).unwrap();
    fs::write(folder.join("panda.toml"), text.replace("[rotor]", "[rotor")).unwrap();
    let answer = phihat(&folder, &["robots", "panda.urdf"]);
    assert!(answer.code == 2 && answer.err.contains("panda.toml"), "{}", answer.err);
    fs::copy(folder.join("studies/panda.toml"), folder.join("panda.toml")).unwrap();
    assert_eq!(phihat(&folder, &["robots", "panda.urdf"]).code, 0);
}

#[test]
fn bad_inputs_give_one_error_and_leave_nothing() {
    let folder = folder("bad");
    let good = fs::read_to_string(folder.join("studies/first.toml")).unwrap();
    let file = |name: &str, text: String| {
        fs::write(folder.join(name), text).unwrap();
        name.to_owned()
    };
    let line = |text: &str, part: &str| 1 + text.lines().position(|l| l.contains(part)).unwrap();
    let unit = file("unit.toml", good.replace("rate_hz =", "rate_khz ="));
    let nan = file("nan.toml", good.replace("duration_s = 7.0", "duration_s = nan"));
    let order =
        file("order.toml", good.replace("inertia_kg_m2 = [0.42,", "inertia_kg_m2 = [-0.42,"));
    let joint = r#"{"name": "elbow", "inertia_kg_m2": 1.0, "kp_per_s2": 9.0, "kd_per_s": 6.0, "a": [25.0, 10.0]}"#;
    let second = file(
        "second.json",
        format!(
            r#"{{"format": "phihat-gains", "version": 3, "study": "s", "study_sha256": "0", "rate_hz": 1000.0,
                "method": "typed", "joints": [{joint}]}}"#
        ),
    );
    let cases: Vec<(Vec<&str>, Vec<String>)> = vec![
        (
            vec!["export", &second, "--format", "ros", "--out", "out"],
            vec!["second.json".to_owned(), "elbow".into(), "order 2".into(), "c-header".into()],
        ),
        (vec!["export", "none.json", "--format", "csv"], vec!["none.json".to_owned()]),
        (vec!["export", &second, "--format", "matlab"], vec!["c-header".to_owned()]),
        (vec!["run", "studies/nothing.toml"], vec!["studies/nothing.toml".to_owned()]),
        (
            vec!["run", &unit],
            vec![format!("unit.toml:{}", line(&good, "rate_hz =")), "rate_hz".into()],
        ),
        (
            vec!["run", &nan],
            vec![format!("nan.toml:{}", line(&good, "duration_s =")), "duration_s".into()],
        ),
        (
            vec!["run", &order],
            vec![format!("order.toml:{}", line(&good, "inertia_kg_m2 =")), "-0.42".into()],
        ),
        (vec!["simulate", "studies"], vec!["studies".to_owned()]),
        (vec!["report", "out/none/trace.parquet"], vec!["out/none/trace.parquet".to_owned()]),
        (
            vec!["report", "studies/first.toml"],
            vec!["studies/first.toml: is not the trace of a run".to_owned()],
        ),
        (vec!["robots", "pandaa"], vec!["panda".to_owned()]),
        (vec!["robots", "nothing.urdf"], vec!["nothing.urdf".to_owned()]),
        (vec!["run"], vec!["STUDY".to_owned()]),
        (vec!["walk"], vec!["walk".to_owned()]),
    ];
    for (arguments, parts) in cases {
        let answer = phihat(&folder, &arguments);
        assert_eq!(answer.code, 2, "{arguments:?}: {} {}", answer.out, answer.err);
        for part in parts {
            assert!(answer.err.contains(&part), "{arguments:?} must name {part}: {}", answer.err);
        }
        assert!(answer.out.is_empty(), "{arguments:?} prints {}", answer.out);
        assert!(!folder.join("out").exists(), "{arguments:?} left something behind");
    }
}

#[test]
fn a_place_that_cannot_be_written_is_named() {
    let folder = folder("unwritable");
    fs::write(folder.join("taken"), "a file, not a folder").unwrap();
    let answer = phihat(&folder, &["run", "studies/first.toml", "--out", "taken"]);
    assert_eq!(answer.code, 2);
    assert!(answer.err.contains("taken"), "{}", answer.err);
    assert_eq!(fs::read_to_string(folder.join("taken")).unwrap(), "a file, not a folder");
}

#[test]
fn a_number_below_zero_is_a_value_out_of_range() {
    let folder = folder("below-zero");
    for (words, option) in [
        (["new", "panda", "--payload", "-1"], "--payload <KG>"),
        (["new", "panda", "--error", "-0.5"], "--error"),
        (["sweep", "study.toml", "--runs", "-3"], "--runs"),
    ] {
        let answer = phihat(&folder, &words);
        assert_eq!(answer.code, 2, "{}", answer.err);
        assert!(answer.err.starts_with("error: invalid value '-"), "{}", answer.err);
        assert!(answer.err.contains(option), "{}", answer.err);
    }
}
