//! Fails if the form changes more of a study than its key, or takes a key that is none of its own.

use phihat_web::FORM;
use serde_json::json;

use crate::support::{ask, text};

#[test]
fn one_key_changes_and_comments_stay() {
    let panda = text("studies/panda.toml");
    let set = |key: &str, value: &str| {
        ask(&json!({ "task": "set", "study": panda, "key": key, "value": value }))
    };
    let told = set("spec.error_bound_rad", "1e-3");
    let expected = panda.replace("error_bound_rad = 5e-4", "error_bound_rad = 1e-3");
    assert_ne!(expected, panda);
    assert_eq!(told["study"].as_str(), Some(&*expected));
    let left_out = set("world.coulomb_extra_nm", " ");
    assert_eq!(left_out["study"].as_str(), Some(&*panda.replace("coulomb_extra_nm = 0.3\n", "")));
    for (key, value) in [("robot.name", "\"ur5\""), ("seed", "one"), ("seed", "1\nx = 2")] {
        assert!(set(key, value)["error"].is_string(), "{key} = {value}");
    }
}

#[test]
fn values_of_the_form_are_those_of_the_study() {
    let told = ask(&json!({ "task": "check", "study": text("studies/panda.toml") }));
    assert_eq!(told["errors"], json!([]));
    let value = |key: &str| {
        let at = FORM.iter().position(|own| own.key == key).unwrap();
        told["values"][at].clone()
    };
    assert_eq!(value("spec.error_bound_rad"), json!("5e-4"));
    assert_eq!(value("sensor.encoder_bits"), json!("18"));
    assert_eq!(value("duration_s"), json!("10.0"));
}
