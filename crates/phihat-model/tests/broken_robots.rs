//! Five hundred broken arms: each real robot's description, with one figure or name of one link or joint
//! changed to one that no arm has. Wrong if one of them were read in silence, or refused without its place;
//! or if the links that a joint moves were passed over.

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
    let (mut refused, mut fixed, mut unneeded, mut read) = (0, 0, 0, Vec::new());
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
                        // What floats on no joint of the arm, or carries none, is fixed, and that is said.
                        Ok(arm) if arm.warnings.iter().any(|w| w.contains("held fixed")) => {
                            assert!(["floating", "planar"].contains(value), "{:?}", arm.warnings);
                            fixed += 1;
                        }
                        // What a base weighs that stands still is not needed, and that is said.
                        Ok(arm) if arm.warnings.iter().any(|w| w.contains("nothing moves it")) => {
                            assert!(["mass", "inertia"].contains(element), "{:?}", arm.warnings);
                            let still = arm.model.frame_names().iter().filter(|name| {
                                arm.model.frame(name).is_some_and(|at| !arm.model.moves(at))
                            });
                            let still: Vec<String> =
                                still.map(|name| format!("link \"{name}\"")).collect();
                            let told = arm.warnings.iter().any(|w| {
                                w.starts_with("broken.urdf:")
                                    && still.iter().any(|link| w.contains(link))
                            });
                            assert!(told, "{:?}", arm.warnings);
                            unneeded += 1;
                        }
                        Ok(_) => read.push(format!("{name}:{line} {element} {attribute}={value}")),
                    }
                }
            }
        }
    }
    println!("{refused} broken arms refused, {} read: {read:#?}", read.len());
    assert!(refused >= 500 && read.is_empty(), "{refused} {read:?}");
    // The first joint of each arm, its last, and those of its fixed ones that stand before these or hang behind them.
    assert_eq!(fixed, 2 * (7 + 2 + 6 + 3));
    // Panda, iiwa14 and UR5 have a base with mass, UR5 one more; eleven breaks each.
    assert_eq!(unneeded, 4 * 11);
}
