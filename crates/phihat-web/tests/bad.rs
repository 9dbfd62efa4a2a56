//! Fails if a text that nobody should trust ends in anything but one error, or if a name reaches the disk.

use serde_json::json;

use crate::support::{ask, text};

#[test]
fn hostile_texts_are_one_error_each() {
    let bomb = "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">]><robot name=\"&b;\"/>";
    let deep = format!("<robot name=\"r\">{}", "<link>".repeat(100_000));
    let first = text("studies/first.toml");
    let long = first.replacen("duration_s = ", "duration_s = 3900 # ", 1);
    assert_ne!(long, first);
    for (task, part) in [
        (json!({ "task": "begin", "file": "a.urdf", "files": { "a.urdf": bomb } }), "a.urdf"),
        (json!({ "task": "begin", "file": "a.urdf", "files": { "a.urdf": deep } }), "a.urdf"),
        (json!({ "task": "begin", "file": "b.urdf", "files": {} }), "b.urdf"),
        (json!({ "task": "begin", "file": "panda", "payload_kg": -1.0 }), "payload_kg"),
        (json!({ "task": "design", "study": "a = [" }), "study.toml:1"),
        (json!({ "task": "run", "study": long }), "3900000 samples of 3 joints"),
        (json!({ "task": "run", "study": first, "gains": "{}" }), "gains.json"),
        (json!({ "task": "verify", "gains": "[[[[" }), "gains.json"),
        (json!({ "task": "export", "gains": "{}", "format": "elf" }), "c-header"),
        (json!({ "task": "fly" }), "fly"),
    ] {
        let told = ask(&task);
        let error = told["error"].as_str().unwrap_or_default();
        assert!(error.contains(part), "{part}: {told}");
    }
}

#[test]
fn a_run_that_is_too_long_is_a_mistake_before_it_is_looked_along() {
    let long = text("studies/first.toml").replacen("duration_s = ", "duration_s = 3900 # ", 1);
    let told = ask(&json!({ "task": "check", "study": long }));
    let said = told["errors"][0]["text"].as_str().unwrap_or_default();
    assert!(said.contains("3900000 samples of 3 joints"), "{told}");
}

#[test]
fn a_name_is_one_of_the_texts_whatever_is_on_the_disk() {
    let there = concat!(env!("CARGO_MANIFEST_DIR"), "/../phihat-model/robots/planar3r.urdf");
    assert!(std::path::Path::new(there).is_file());
    let task = json!({ "task": "arm", "file": there, "files": {} });
    assert!(ask(&task)["error"].as_str().unwrap().contains("no file of this name was given"));
    let study =
        text("studies/first.toml").replace("name = \"planar3r\"", &format!("file = {there:?}"));
    let told = ask(&json!({ "task": "check", "study": study }));
    assert!(told["errors"][0]["text"].as_str().unwrap().contains("no file of this name was given"));
}
