//! Five hundred broken arms: each real robot's description, with one figure or name of one link or joint made
//! what no arm has. Wrong if one of them were read, or refused without saying where.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "tests")]

use std::path::Path;

use phihat_model::Robot;

/// The value of every attribute of this name in an element of this name: where it begins and ends.
fn places(text: &str, element: &str, attribute: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices(&format!("<{element} ")) {
        let end = at + text[at..].find('>').unwrap();
        if let Some(from) = text[at..end].find(&format!(" {attribute}=\"")) {
            let start = at + from + attribute.len() + 3;
            found.push((start, start + text[start..].find('"').unwrap()));
        }
    }
    found
}

/// Element, attribute, and what no arm has there.
const BREAKS: &[(&str, &str, &[&str])] = &[
    ("mass", "value", &["-1", "nan", "inf", "a lot", ""]),
    ("inertia", "ixx", &["-1", "nan", "1e400", "x"]),
    ("inertia", "izz", &["-1", "inf"]),
    ("parent", "link", &["nowhere", ""]),
    ("child", "link", &["nowhere"]),
    ("axis", "xyz", &["0 0 0", "1 0", "nan 0 1"]),
    ("limit", "lower", &["5000000", "nan"]),
    ("limit", "effort", &["-3", "nan"]),
    ("joint", "type", &["floating", "planar", "hinge"]),
];

#[test]
fn f29_five_hundred_broken_arms_are_refused_with_their_place() {
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("robots");
    let (mut refused, mut fixed, mut read) = (0, 0, Vec::new());
    for name in ["panda", "iiwa14", "ur5", "planar3r"] {
        let text = std::fs::read_to_string(robots.join(format!("{name}.urdf"))).unwrap();
        for (element, attribute, values) in BREAKS {
            for (start, end) in places(&text, element, attribute) {
                for value in *values {
                    let broken = format!("{}{value}{}", &text[..start], &text[end..]);
                    let line = text[..start].matches('\n').count() + 1;
                    match Robot::from_text(&broken, None, "broken.urdf") {
                        Err(error) => {
                            let message = error.to_string();
                            assert!(message.starts_with("broken.urdf:"), "{message}");
                            refused += 1;
                        }
                        // A base that floats is fixed, and that is said.
                        Ok(arm) if arm.warnings.iter().any(|w| w.contains("held fixed")) => {
                            assert!(["floating", "planar"].contains(value), "{:?}", arm.warnings);
                            fixed += 1;
                        }
                        Ok(_) => read.push(format!("{name}:{line} {element} {attribute}={value}")),
                    }
                }
            }
        }
    }
    println!("{refused} broken arms refused, {} read: {read:#?}", read.len());
    assert!(refused >= 500 && read.is_empty(), "{refused} {read:?}");
    // Those that stand on the base: one of each kind per arm and such a joint.
    assert!(fixed <= 16, "{fixed}");
}
