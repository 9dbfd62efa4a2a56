//! Gains documents of earlier versions, whose error bounds have other names.
//!
//! Wrong if such a document were refused, or read with other numbers.

use phihat_certificate::{Bounds, ClassPace, Gains};

const TEXT: &str = include_str!("forged/two_joints.json");

/// A text with names of before in place of those of now.
fn before(text: &str, names: &[(&str, &str)]) -> String {
    names.iter().fold(text.to_owned(), |text, (before, now)| {
        text.replace(&format!("\"{now}\":"), &format!("\"{before}\":"))
    })
}

#[test]
fn a_document_of_before_is_read_as_one_of_now() {
    let old = before(
        TEXT,
        &[
            ("error_max_rad", "error_bound_rad"),
            ("velocity_error_max_rad_s", "velocity_error_bound_rad_s"),
            ("error_max_m", "error_bound_m"),
        ],
    );
    assert_ne!(old, TEXT);
    let (old, new) = (Gains::from_json(&old).unwrap(), Gains::from_json(TEXT).unwrap());
    assert_eq!(old, new);
    let written = old.to_json().unwrap();
    assert!(written.contains("error_bound_rad") && !written.contains("error_max_rad"));
}

#[test]
fn bounds_without_a_tube_are_read_under_their_old_names() {
    let old = r#"{ "error_rad": 1e-3, "velocity_error_rad_s": 2e-2, "integral_rad_s": null }"#;
    let read: Bounds = serde_json::from_str(old).unwrap();
    assert_eq!((read.error_bound_rad, read.velocity_error_bound_rad_s), (1e-3, 2e-2));
    let old =
        r#"{ "factor": 2.0, "error_rad": 3e-3, "torque_step_nm": null, "spectral_radius": 0.5 }"#;
    let pace: ClassPace = serde_json::from_str(old).unwrap();
    assert_eq!(pace.error_bound_rad, Some(3e-3));
}
