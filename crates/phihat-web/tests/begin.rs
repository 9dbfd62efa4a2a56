//! Fails if a bare description does not become a study whose gains run inside their bound, or if a design goes on after
//! its listener ended it.

use core::ops::ControlFlow;
use std::cell::Cell;
use std::path::Path;

use phihat_model::NamedTexts;
use phihat_session::{arm, designed_in_steps, study_of_texts};
use phihat_synthesis::{Advice, Steps};
use serde_json::{Value, json};

use crate::support::{ask, heard, searched, text};

/// An arm of one joint: half a kilogram 0.1 m out.
const ONE: &str = r#"<robot name="one"><link name="base"/>
    <joint name="lift" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="6" velocity="3"/></joint>
    <link name="arm"><inertial><origin xyz="0.1 0 0"/><mass value="0.5"/>
    <inertia ixx="0.005" ixy="0" ixz="0" iyy="0.005" iyz="0" izz="0.005"/></inertial></link></robot>"#;

#[test]
fn a_dropped_description_becomes_a_certified_run() {
    let files = json!({ "one.urdf": ONE });
    let told = ask(&json!({ "task": "arm", "file": "one.urdf", "files": files }));
    assert_eq!(told["joints"], json!(["lift"]), "{}", told["error"]);
    let (begun, steps) = heard(&json!({ "task": "begin", "file": "one.urdf", "files": files }));
    assert_eq!(begun["infeasible"], json!(null), "{}", begun["error"]);
    assert!(!steps.is_empty());
    let texts = |task: &str, gains: Option<&str>| {
        let (study, files) = (&begun["study"], &begun["files"]);
        json!({ "task": task, "study": study, "files": files, "gains": gains })
    };
    assert_eq!(ask(&texts("check", None))["errors"], json!([]));
    let designed = ask(&texts("design", None));
    let gains = designed["gains"].as_str();
    let run = ask(&texts("run", gains));
    assert_eq!((&run["good"], &run["promise"]), (&json!(true), &json!(true)), "{}", run["error"]);
    let joint = &run["joints"][0];
    let [measured, bound, accepted] =
        ["measured_rad", "bound_rad", "accepted_rad"].map(|key| joint[key].as_f64().unwrap());
    assert!(
        0.0 < measured && measured <= bound && bound <= accepted,
        "{measured} {bound} {accepted}"
    );
    let header = ask(&json!({ "task": "export", "gains": gains, "format": "c-header" }));
    assert!(header["text"].as_str().unwrap().contains("#ifndef"));
}

#[test]
fn an_arm_in_two_files_stays_in_them() {
    let robots = "crates/phihat-model/robots/planar3r";
    let [urdf, toml] = ["urdf", "toml"].map(|kind| text(&format!("{robots}.{kind}")));
    let files = json!({ "planar3r.urdf": urdf, "planar3r.toml": toml });
    let begun = ask(&json!({ "task": "begin", "file": "planar3r.urdf", "files": files }));
    let study = begun["study"].as_str().unwrap_or_default();
    assert!(study.contains("file = \"planar3r.urdf\""), "{} {study}", begun["error"]);
    assert_eq!(begun["files"], json!({}));
    let checked = ask(&json!({ "task": "check", "study": study, "files": files }));
    assert_eq!(checked["errors"], json!([]));
}

#[test]
fn a_design_ends_at_the_step_that_its_listener_refuses() {
    let (path, files) = (Path::new("first.toml"), NamedTexts::alone([]));
    let study = study_of_texts(&searched(), path, &files).unwrap();
    let arm = arm(&study, path).unwrap();
    let count = Cell::new(0);
    let begins = |_: &str| {
        count.set(count.get() + 1);
        if count.get() < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let steps = (Advice::Clauses, Steps::to(&begins));
    let told = designed_in_steps(&study, &arm, path, steps).unwrap_err().to_string();
    assert!(told.contains("cancelled"), "{told}");
    assert_eq!(count.get(), 3);
}

#[test]
fn the_search_for_an_error_ends_with_the_gains_that_a_design_finds() {
    let files = json!({ "one.urdf": ONE });
    let begun = ask(&json!({ "task": "begin", "file": "one.urdf", "files": files }));
    let (study, files) = (&begun["study"], &begun["files"]);
    let designed = ask(&json!({ "task": "design", "study": study, "files": files }));
    assert!(begun["gains"].is_string(), "{}", begun["error"]);
    assert_eq!(begun["gains"], designed["gains"]);
    // The first error that is kept is no smaller, and has gains too.
    let first = ask(
        &json!({ "task": "begin", "file": "one.urdf", "files": { "one.urdf": ONE }, "first_kept": true }),
    );
    let error = |told: &Value| told["error_bound_rad"][0].as_f64().unwrap();
    assert!(first["gains"].is_string() && error(&first) >= error(&begun), "{}", first["error"]);
}

#[test]
fn a_description_in_xacro_is_read_with_the_files_that_it_includes() {
    let (head, tail) =
        (r#"<robot name="one" xmlns:xacro="http://ros.org/wiki/xacro">"#, "</robot>");
    let body = ONE.replace(r#"<robot name="one">"#, "").replace(tail, "");
    let lifted = body.replace("\"0.5\"", "\"${mass}\"");
    assert_ne!(lifted, body);
    let part =
        format!("{head}<xacro:macro name=\"arm\" params=\"mass\">{lifted}</xacro:macro>{tail}");
    let main = format!(
        "{head}<xacro:include filename=\"$(find one_description)/urdf/part.xacro\"/>\
         <xacro:arm mass=\"0.5\"/>{tail}"
    );
    let files = json!({ "main.urdf.xacro": main, "part.xacro": part });
    let ask_of = |files: &Value| {
        ask(
            &json!({ "task": "begin", "file": "main.urdf.xacro", "files": files, "error_rad": 0.05 }),
        )
    };
    let begun = ask_of(&files);
    let plain = ask(
        &json!({ "task": "begin", "file": "one.urdf", "files": { "one.urdf": ONE }, "error_rad": 0.05 }),
    );
    assert_eq!(begun["error"], json!(null), "{}", begun["error"]);
    let numbers = |told: &Value| {
        let gains: Value = serde_json::from_str(told["gains"].as_str().unwrap_or("{}")).unwrap();
        gains["joints"].clone()
    };
    assert!(numbers(&plain).is_array());
    assert_eq!(numbers(&begun), numbers(&plain));
    let alone = ask_of(&json!({ "main.urdf.xacro": main }));
    assert!(alone["error"].as_str().unwrap().contains("part.xacro"), "{alone}");
}
