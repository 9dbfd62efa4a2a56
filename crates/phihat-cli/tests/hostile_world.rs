//! The studies of what goes wrong stay within their bounds, and a robot that stops says why. Wrong if a
//! study's story were not what happens.

use crate::support::{folder, json, phihat};

#[test]
fn every_study_keeps_its_bound() {
    let folder = folder("hostile_world");
    for study in [
        "payload_drop",
        "weak_drive",
        "sensor_freeze",
        "stiction",
        "saturation_step",
        "estop_restart",
        "franka",
    ] {
        let file = format!("studies/{study}.toml");
        let result = json(&folder, &["simulate", &file, "--json"]);
        assert_eq!(result["metrics"]["within_spec"], true, "{study}");
        assert!(result["stopped"].is_null() && result["diverged"].is_null(), "{study}");
    }
}

#[test]
fn an_e_stop_and_the_restart_are_in_the_report() {
    let folder = folder("estop");
    let answer = phihat(&folder, &["run", "studies/estop_restart.toml"]);
    assert_eq!(answer.code, 0, "{}{}", answer.out, answer.err);
    let page = std::fs::read_to_string(folder.join("out/estop_restart/report.html")).unwrap();
    let told = ["now tracking", "now safe-stop", "refused", "now armed", "now tracking"];
    let mut rest = page.as_str();
    for what in told {
        let at = rest.find(what).unwrap_or_else(|| panic!("{what} is not told, or not in order"));
        rest = &rest[at + what.len()..];
    }
}

#[test]
fn a_robot_that_stops_says_when_where_and_why() {
    let folder = folder("stopped");
    let file = folder.join("studies/franka.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let reckless = "name = \"robot\"\ncontroller_keeps = false\nadds_gravity = false\nfirst_torque_max_nm = 100.0";
    std::fs::write(&file, text.replace("name = \"robot\"", reckless)).unwrap();
    let answer = phihat(&folder, &["run", "studies/franka.toml"]);
    assert_eq!(answer.code, 1, "{}", answer.err);
    assert!(answer.err.contains("forecast: panda_joint2 needs"), "{}", answer.err);
    assert!(answer.out.contains("STOPPED by the robot (franka)"), "{}", answer.out);
    assert!(answer.out.contains("N·m in one sample, at most 1 is allowed"), "{}", answer.out);
    let page = std::fs::read_to_string(folder.join("out/franka/report.html")).unwrap();
    assert!(page.contains("STOPPED by the robot"), "the report says so too");
}
