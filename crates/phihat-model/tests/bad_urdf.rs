//! Every URDF that no arm has is refused, with file, line or name, and reason; hostile ones soon.

use std::fmt::Write as _;
#[cfg(unix)]
use std::time::Duration;

use phihat_model::Robot;

const GOOD: &str = r#"<robot name="good">
<link name="base"/>
<link name="arm"><inertial><origin xyz="0 0 0.1"/><mass value="1"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<link name="tip"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
<origin xyz="0 0 1" rpy="0 0 0"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="10" velocity="2"/><dynamics damping="0.1" friction="0.2"/></joint>
<joint name="weld" type="fixed"><parent link="arm"/><child link="tip"/></joint>
</robot>"#;

/// Mistakes: text of the good one, its replacement, and words of the message.
const MISTAKES: &[(&str, &str, &[&str])] = &[
    ("<mass value=\"1\"/>", "<mass value=\"-1\"/>", &[":3:", "\"arm\"", "-1"]),
    ("<mass value=\"1\"/>", "<mass value=\"NaN\"/>", &[":3:", "\"arm\"", "NaN"]),
    ("<mass value=\"1\"/>", "<mass value=\"inf\"/>", &[":3:", "\"arm\"", "inf"]),
    ("<mass value=\"1\"/>", "<mass value=\"one\"/>", &[":3:", "\"arm\"", "one"]),
    ("<mass value=\"1\"/>", "<mass/>", &[":3:", "\"arm\"", "value"]),
    ("<mass value=\"1\"/>", "", &[":3:", "\"arm\"", "<mass>"]),
    ("ixx=\"0.1\"", "ixx=\"-0.1\"", &[":3:", "\"arm\"", "-0.1"]),
    ("ixy=\"0\"", "ixy=\"0.2\"", &[":3:", "\"arm\"", "principal"]),
    ("izz=\"0.1\"", "", &[":3:", "\"arm\"", "izz"]),
    ("<origin xyz=\"0 0 0.1\"/>", "<origin xyz=\"0 0\"/>", &[":3:", "\"arm\"", "three"]),
    ("<origin xyz=\"0 0 0.1\"/>", "<origin xyz=\"0 0 0 1\"/>", &[":3:", "three"]),
    ("link name=\"tip\"", "link name=\"arm\"", &[":5:", "\"arm\"", "another"]),
    ("link name=\"tip\"", "link name=\"\"", &[":5:", "no name"]),
    ("link name=\"tip\"", "link", &[":5:", "no name"]),
    ("joint name=\"weld\"", "joint name=\"turn\"", &[":9:", "\"turn\"", "another"]),
    ("joint name=\"weld\" type", "joint kind", &[":9:", "no name"]),
    ("type=\"revolute\"", "type=\"floating\"", &["bad.urdf", "\"turn\"", "floating"]),
    ("type=\"revolute\"", "type=\"planar\"", &["bad.urdf", "\"turn\"", "planar"]),
    ("type=\"revolute\"", "type=\"Revolute\"", &[":6:", "\"turn\"", "Revolute"]),
    ("type=\"revolute\"", "", &[":6:", "\"turn\"", "type"]),
    ("type=\"revolute\"", "type=\"fixed\"", &["bad.urdf", "no joint moves"]),
    ("<child link=\"tip\"/>", "<child link=\"top\"/>", &[":9:", "\"weld\"", "\"top\""]),
    ("<parent link=\"arm\"/>", "<parent link=\"leg\"/>", &[":9:", "\"weld\"", "\"leg\""]),
    ("<parent link=\"arm\"/>", "", &[":9:", "\"weld\"", "parent"]),
    ("<child link=\"tip\"/>", "<child/>", &[":9:", "\"weld\"", "link"]),
    ("<child link=\"tip\"/>", "<child link=\"arm\"/>", &[":9:", "\"weld\"", "\"turn\""]),
    ("<child link=\"tip\"/>", "<child link=\"base\"/>", &["bad.urdf"]),
    ("<parent link=\"arm\"/>", "<parent link=\"tip\"/>", &[":5:", "\"tip\"", "loop"]),
    ("<link name=\"tip\"/>", "<link name=\"tip\"/><link name=\"loose\"/>", &["\"loose\"", "root"]),
    ("xyz=\"0 0 1\"", "xyz=\"0 0 1 0\"", &[":6:", "\"turn\"", "three", "too many"]),
    ("xyz=\"0 0 1\"", "xyz=\"0,0 0,1 1\"", &[":6:", "\"turn\"", "a point before decimals"]),
    ("xyz=\"0 0 1\"", "xyz=\"$(arg height)\"", &[":6:", "\"turn\"", "expand the file"]),
    ("xyz=\"0 0 1\"", "xyz=\"$(optenv H $(arg h))\"", &[":6:", "\"turn\"", "expand the file"]),
    ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>", &[":6:", "\"turn\"", "direction"]),
    ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1\"/>", &[":6:", "\"turn\"", "three"]),
    ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 nan 0\"/>", &[":6:", "\"turn\"", "finite"]),
    ("lower=\"-1\"", "lower=\"2\"", &[":6:", "\"turn\"", "2", "below"]),
    ("lower=\"-1\" upper=\"1\"", "lower=\"1e6\" upper=\"-1\"", &[":6:", "\"turn\"", "below"]),
    ("lower=\"-1\" upper=\"1\"", "lower=\"1\" upper=\"1\"", &[":6:", "\"turn\"", "below"]),
    (
        "<limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"2\"/>",
        "",
        &[":6:", "\"turn\"", "continuous"],
    ),
    ("<axis", "<xacro:if value=\"1\"/><axis", &[":7:", "xacro", "expand"]),
    ("effort=\"10\"", "effort=\"-10\"", &[":6:", "\"turn\"", "effort", "-10"]),
    ("damping=\"0.1\"", "damping=\"-0.1\"", &[":6:", "\"turn\"", "damping", "-0.1"]),
    ("<axis", "<mimic joint=\"weld\"/><axis", &["bad.urdf", "\"turn\"", "mimic"]),
    ("<origin xyz=\"0 0 1\"", "<origin/><origin", &[":6:", "\"turn\"", "more than one <origin>"]),
    ("<robot name=\"good\">", "<robot name=\"good\"", &["bad.urdf:"]),
    ("</robot>", "", &["bad.urdf:"]),
    ("</joint>\n<joint", "</link>\n<joint", &["bad.urdf:8"]),
    ("<link name=\"base\"/>", "<link name=\"base\" name=\"b\"/>", &["bad.urdf:2"]),
    ("<link name=\"base\"/>", "<link name=\"&x;\"/>", &["bad.urdf:2"]),
    (
        "<robot name=\"good\">",
        "<!DOCTYPE robot [<!ENTITY x \"y\">]>\n<robot>",
        &[":1:", "document type"],
    ),
];

#[test]
fn the_good_one_is_read() {
    let robot = Robot::from_text(GOOD, None, "good.urdf").unwrap();
    assert!(robot.warnings.is_empty());
    assert_eq!(robot.model.frame_names(), ["base", "arm", "tip"]);
    let joint = &robot.joints[0];
    assert_eq!((joint.friction.viscous, joint.friction.coulomb), (0.1, 0.2));
    assert_eq!((joint.torque_max, joint.velocity_max), (Some(10.0), Some(2.0)));
}

#[test]
fn each_mistake_is_named_with_its_place() {
    for (from, to, clues) in MISTAKES {
        assert!(GOOD.contains(from), "{from}");
        let text = GOOD.replacen(from, to, 1);
        let error = Robot::from_text(&text, None, "bad.urdf");
        let Err(error) = error else { panic!("{to} instead of {from} is read") };
        let message = error.to_string();
        assert!(message.starts_with("bad.urdf"), "{message}");
        for clue in *clues {
            assert!(message.contains(clue), "{clue} is not in: {message}");
        }
    }
    assert!(MISTAKES.len() >= 40);
}

#[test]
fn a_joint_that_moves_no_mass_is_refused() {
    let massless = GOOD.replace("<inertial>", "<!--").replace("</inertial>", "-->");
    let message = Robot::from_text(&massless, None, "bad.urdf").unwrap_err().to_string();
    assert!(message.contains("\"turn\"") && message.contains("no mass"), "{message}");
}

#[test]
fn odd_but_usable_figures_are_warned_about() {
    for (from, to, clue) in [
        ("izz=\"0.1\"", "izz=\"0.3\"", "triangle"),
        ("xyz=\"0 1 0\"", "xyz=\"0 2 0\"", "length"),
        ("effort=\"10\"", "effort=\"0\"", "effort"),
        ("lower=\"-1\" upper=\"1\"", "", "turns without end"),
        ("ixy=\"0\"", "ixy=\"0.10001\"", "by rounding"),
        ("</inertial>", "</inertial><inertial/>", "the first is read"),
        ("<mass value=\"1\"/>", "<mass value=\"0\"/>", "inertia but no mass"),
    ] {
        let robot = Robot::from_text(&GOOD.replacen(from, to, 1), None, "odd.urdf").unwrap();
        assert!(robot.warnings.iter().any(|w| w.contains(clue)), "{clue}: {:?}", robot.warnings);
    }
}

/// A hostile file of a size that is given in parts.
type Hostile = fn(usize) -> String;

/// Hostile files: word of the refusal, number of parts from which on they are refused, and the text.
const HOSTILE: [(&str, usize, Hostile); 8] = [
    ("elements inside each other", 200_000, |n| {
        format!("<robot>{}{}</robot>", "<a>".repeat(n), "</a>".repeat(n))
    }),
    ("attributes", 100_000, |n| {
        let attribute = |mut text: String, k| {
            let _ = write!(text, " a{k}=\"1\"");
            text
        };
        format!("<robot><link {}/></robot>", (0..n).fold(String::new(), attribute))
    }),
    ("elements", 60_000, |n| format!("<robot>{}</robot>", "<a/>".repeat(n))),
    ("bytes", 5 << 20, |n| format!("<robot>{}</robot>", " ".repeat(n))),
    ("1024 bytes", 2000, |n| GOOD.replace("\"tip\"", &format!("\"{}\"", "n".repeat(n)))),
    ("does not end", 100_000, |n| format!("<robot {}", "<".repeat(n))),
    ("links", 4097, |n| {
        let links = (0..n).map(|k| format!("<link name=\"l{k}\"/>")).collect::<Vec<_>>().concat();
        format!("<robot>{links}</robot>")
    }),
    ("entities", 1000, |n| format!("<!DOCTYPE r [{}]><robot/>", "<!ENTITY a \"b\">".repeat(n))),
];

#[test]
fn hostile_files_are_refused() {
    for (what, parts, hostile) in HOSTILE {
        let message = Robot::from_text(&hostile(parts), None, "h").unwrap_err().to_string();
        assert!(message.contains(what), "{what} is not in: {message}");
    }
}

/// Four times the file may take four times the work, and not sixteen times: wrong if a refusal took quadratic time.
///
/// Both are counted in one run, in processor time of this thread, the least of five each, so that neither the
/// machine nor its other work decides. Below 2 ms nothing counts.
#[cfg(unix)]
#[test]
fn a_refusal_takes_no_more_than_linear_time() {
    let least = |text: &str| {
        let once = |_| {
            let began = crate::support::processor_time();
            assert!(Robot::from_text(text, None, "h").is_err());
            crate::support::processor_time().saturating_sub(began)
        };
        (0..5).map(once).min().unwrap()
    };
    for (what, parts, hostile) in HOSTILE {
        let (small, large) = (least(&hostile(parts)), least(&hostile(4 * parts)));
        println!("{what}: {small:?}, and {large:?} for four times the file");
        assert!(large <= 8 * small + Duration::from_millis(2), "{what}: {small:?}, {large:?}");
    }
}

#[test]
fn thirty_three_joints_are_one_too_many_and_a_part_is_proposed() {
    let chain = |n: usize| {
        let mut parts = vec![crate::support::link("l0", "")];
        for k in 1..=n {
            let body = crate::support::inertial(1.0, [0.1; 3], [0.1, 0.0, 0.0, 0.1, 0.0, 0.1]);
            let (name, parent) = (format!("l{k}"), format!("l{}", k - 1));
            parts.push(crate::support::link(&name, &body));
            let ends = [parent.as_str(), name.as_str()];
            parts.push(crate::support::joint(&format!("j{k}"), "revolute", ends, "1 0 0", "0 1 0"));
        }
        Robot::from_text(&format!("<robot>{}</robot>", parts.concat()), None, "chain")
    };
    assert_eq!(chain(32).unwrap().joints.len(), 32);
    let message = chain(33).unwrap_err().to_string();
    assert!(message.contains("33 joints move") && message.contains("base and tip"), "{message}");
}

#[test]
fn no_damage_to_a_file_makes_the_reader_panic() {
    let mut random = crate::support::Random(19);
    for _ in 0..3000 {
        let mut bytes = GOOD.as_bytes().to_vec();
        for _ in 0..=random.next() % 4 {
            let at = random.below(bytes.len().max(1));
            if bytes.is_empty() {
                break;
            }
            match random.next() % 3 {
                0 => bytes[at] = b"<>\"/=&x0- "[random.below(10)],
                1 => drop(bytes.remove(at)),
                _ => bytes.truncate(at.max(1)),
            }
        }
        let _ = Robot::from_text(&String::from_utf8_lossy(&bytes), None, "damaged");
    }
}
