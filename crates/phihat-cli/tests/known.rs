//! Arms known by name, from a description to a drive. Wrong if a known arm were not recognised or its interface not
//! used, if its robot's rules stopped the drive, or if a limit acted in it.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::support::{folder, json, phihat};

/// A folder with one of the model crate's descriptions.
fn with_arm(name: &str, file: &str) -> PathBuf {
    let folder = folder(name);
    let arms = Path::new(env!("CARGO_MANIFEST_DIR")).join("../phihat-model/tests/arms");
    fs::copy(arms.join(file), folder.join(file)).unwrap();
    folder
}

fn read(folder: &Path, file: &str) -> String {
    fs::read_to_string(folder.join(file)).unwrap()
}

#[test]
fn an_fr3_with_its_hand_is_driven_within_its_robots_rules() {
    let folder = with_arm("known-fr3", "fr3_hand.urdf");
    let new = ["new", "fr3_hand.urdf", "--out", "fr3.toml", "--error", "8", "--json"];
    let told = json(&folder, &new);
    assert_eq!(told["exit_code"], 0, "{told:#}");
    let notes = told["notes"].to_string();
    for said in [
        "recognised as Franka Research 3",
        "fr3_joint1",
        "profile franka",
        "--profile ideal",
        "100 Hz",
        "fr3_finger_joint1 at 0",
        "a payload is on fr3_hand_tcp",
    ] {
        assert!(notes.contains(said), "{said}: {notes}");
    }
    let arm: toml::Table = read(&folder, "fr3_arm.toml").parse().unwrap();
    assert_eq!(
        (arm["profile"]["name"].as_str(), arm["tip"].as_str()),
        (Some("franka"), Some("fr3_hand_tcp"))
    );
    assert_eq!(arm["joints"].as_array().unwrap().len(), 7);
    // The tube is about the loop that the study describes, the robot's interface in it.
    let designed = phihat(&folder, &["design", "fr3.toml", "--out", "gains.json"]);
    assert_eq!(designed.code, 0, "{}{}", designed.out, designed.err);
    let gains: Value = serde_json::from_str(&read(&folder, "gains.json")).unwrap();
    let tube = gains["certificate"]["tube"]["joints"].as_array().unwrap();
    assert!(tube.iter().all(|joint| joint["error_bound_rad"].as_f64().unwrap() <= 8e-3));
    // What the study says to do before a drive; a part of its motion.
    let study = read(&folder, "fr3.toml")
        .replace("# [supervisor]\n# error_stop", "[supervisor]\nerror_stop");
    assert!(study.contains("\n[supervisor]\nerror_stop_rad = 0.1\n"), "{study}");
    fs::write(folder.join("drive.toml"), study.replace("duration_s = 10.0", "duration_s = 3.0"))
        .unwrap();
    let driven = driven(&folder);
    let drive = &driven["drive"];
    assert_eq!(
        (&driven["verdict"], &drive["end"]),
        (&"within_spec".into(), &"complete".into()),
        "{driven:#}"
    );
    assert_eq!((&drive["samples"], &drive["lost"]), (&3000.into(), &0.into()), "{drive:#}");
    let joints = driven["metrics"]["joints"].as_array().unwrap();
    for joint in joints {
        let counts = (&joint["saturated_samples"], &joint["rate_limited_samples"]);
        assert_eq!(counts, (&0.into(), &0.into()), "{joint:#}");
    }
    let step = |joint: &Value| joint["tau_step_max_nm"].as_f64().unwrap();
    let most = joints.iter().map(step).fold(0.0, f64::max);
    println!("largest torque step: {most} N·m per sample");
    assert!(0.0 < most && most < 1.0, "{most} N·m per sample");
}

/// `drive.toml` with `gains.json`, on `phihat serve` with the same study.
fn driven(folder: &Path) -> Value {
    let mut robot = Command::new(env!("CARGO_BIN_EXE_phihat"))
        .args([
            "serve",
            "drive.toml",
            "--fci",
            "--port",
            "0",
            "--json",
            "--cycles",
            "3000",
            "--out",
            "robot",
        ])
        .current_dir(folder)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(robot.stdout.take().unwrap()).lines();
    let first: Value = serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap();
    let link = format!("fci://{}", first["listening"].as_str().unwrap());
    let drive = [
        "drive",
        "drive.toml",
        "--gains",
        "gains.json",
        "--on",
        &link,
        "--accept",
        "real-time",
        "--json",
    ];
    let driven = phihat(folder, &drive);
    if driven.code != 0 {
        robot.kill().unwrap();
    }
    lines.for_each(drop);
    robot.wait().unwrap();
    assert_eq!(driven.code, 0, "{}{}", driven.out, driven.err);
    serde_json::from_str(&driven.out).unwrap()
}

#[test]
fn a_ur_and_a_gen3_have_their_interface_and_who_says_otherwise_has_his() {
    for (file, name, profile, rate, tip) in [
        ("ur5e_gripper.urdf", "ur5e", "ur", "500.0", "gripper_base"),
        ("gen3_camera.urdf", "gen3", "kortex", "1000.0", "end_effector_link"),
    ] {
        let folder = with_arm(&format!("known-{name}"), file);
        let told = json(&folder, &["robots", file, "--json"]);
        let known = &told["known"];
        assert_eq!(
            (&known["name"], &known["profile"], &told["tip"]),
            (&name.into(), &profile.into(), &tip.into())
        );
        assert!(known["encoder"].as_str().unwrap().contains("not published"));
        // Drives that cannot hold the arm: what is written is looked at, and nothing is searched.
        let new = |more: &[&str]| {
            let new =
                ["new", file, "--torque-max", "0.1", "--out", "study.toml", "--force", "--json"];
            let told = json(&folder, &[&new, more].concat());
            let arm: toml::Table = read(&folder, "study_arm.toml").parse().unwrap();
            (
                told["notes"].to_string(),
                arm["profile"]["name"].as_str().unwrap().to_owned(),
                read(&folder, "study.toml"),
            )
        };
        let (notes, own, study) = new(&[]);
        assert!(notes.contains("recognised as"), "{notes}");
        assert_eq!(own, profile);
        assert!(
            study.contains(&format!("rate_hz = {rate}\n"))
                && study.contains("[profile]\nname = \"robot\"\n"),
            "{study}"
        );
        let (notes, own, study) = new(&["--profile", "ideal"]);
        assert!(
            notes.contains("recognised as") && own == "ideal" && !study.contains("[profile]"),
            "{study}"
        );
        let (notes, own, _) = new(&["--arm", "none"]);
        assert!(!notes.contains("recognised as") && own == "ideal", "{notes}");
    }
}

#[test]
fn a_wrong_name_and_an_unclear_tool_are_answered_with_the_choices() {
    let folder = with_arm("known-mistakes", "fr3_hand.urdf");
    let two = read(&folder, "fr3_hand.urdf").replace(
        "</robot>",
        "<link name=\"probe_tcp\"/><joint name=\"probe\" type=\"fixed\"><parent link=\"fr3_link8\"/>\
         <child link=\"probe_tcp\"/></joint></robot>",
    );
    fs::write(folder.join("two.urdf"), two).unwrap();
    for (arguments, said) in [
        (
            &["new", "two.urdf"][..],
            &["which link does the work", "--tip fr3_hand_tcp", "--tip probe_tcp"][..],
        ),
        (&["new", "fr3_hand.urdf", "--arm", "fr4"], &["fr4", "openarm"]),
        (&["new", "fr3_hand.urdf", "--arm", "ur5e"], &["UR5e has 6 joints", "7"]),
        (&["robots", "fr3_hand.urdf", "--arm", "fr4"], &["fr4", "openarm"]),
        (&["robots", "fr3_hand.urdf", "--arm", "ur5e"], &["UR5e has 6 joints", "7"]),
        (&["new", "panda", "--arm", "fr3"], &["file of its own"]),
        (&["new", "fr3"], &["known by name", "name its URDF"]),
    ] {
        let answer = phihat(&folder, arguments);
        assert_eq!(answer.code, 2, "{arguments:?}: {}{}", answer.out, answer.err);
        assert!(said.iter().all(|part| answer.err.contains(part)), "{arguments:?}: {}", answer.err);
    }
}

#[test]
fn the_page_has_every_known_arm() {
    let page =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/book/src/how-to/known-arms.md");
    let page = fs::read_to_string(page).unwrap();
    for arm in phihat_model::KnownArm::all() {
        let row =
            page.lines().find(|line| line.starts_with(&format!("| `{}` |", arm.name))).unwrap();
        let [title, profile] = [&arm.title, &arm.profile].map(|word| row.contains(word.as_str()));
        assert!(title && profile, "{row}");
    }
}
