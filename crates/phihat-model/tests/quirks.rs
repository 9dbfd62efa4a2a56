//! Quirks of published descriptions, each as a small arm of ours: read as the correctly written arm, bit for
//! bit, with a line that names the element; or refused with a remedy. Fails where a quirk is read in another
//! way, or in silence.

use phihat_model::{Part, Robot, Workspace};

const LINK: &str = r#"<inertial><origin xyz="0.02 -0.01 0.1" rpy="0.1 0.2 0.3"/><mass value="1.5"/>
<inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.03" iyz="0" izz="0.025"/></inertial>"#;

/// A tower of links `l0`, `l1`, … with one joint `j1`, `j2`, … of each kind between them.
fn tower(kinds: &[&str]) -> String {
    let part = |(below, kind): (usize, &&str)| {
        let above = below + 1;
        format!(
            "<link name=\"l{above}\">{LINK}</link>\n<joint name=\"j{above}\" type=\"{kind}\"><parent \
             link=\"l{below}\"/><child link=\"l{above}\"/><origin xyz=\"0.07 0 -0.69\" rpy=\"0 -1.5708 3.1416\"/>\
             <axis xyz=\"0 1 0\"/><limit lower=\"-0.5\" upper=\"0.25\" effort=\"9\" velocity=\"2\"/></joint>\n"
        )
    };
    let parts: String = kinds.iter().enumerate().map(part).collect();
    format!("<robot name=\"tower\">\n<link name=\"l0\"/>\n{parts}</robot>\n")
}

/// Correct text, in the first joint that has it, and its replacement; the element that the warning names, and
/// its word.
const QUIRKS: &[(&str, &str, &[&str])] = &[
    // Bullet's bicycle.
    ("0.07 0 -0.69", "0.07, 0, -0.69", &["joint \"j1\" (line 5)", "not commas"]),
    // Clearpath's Husky, where nobody expanded what roslaunch does.
    (
        "0.07 0 -0.69",
        "$(optenv IMU_XYZ 0.07 0 -0.69)",
        &["\"j1\" (line 5)", "environment variable"],
    ),
    // Bullet's biped and its cube on three slides.
    (
        "lower=\"-0.5\" upper=\"0.25\"",
        "lower=\"0.25\" upper=\"-0.5\"",
        &["\"j1\"", "wrong way round"],
    ),
    // Ghost Robotics' Spirit 40.
    (
        "<axis xyz=\"0 1 0\"/>",
        "<axis xyz=\"0 1 0\"/><axis xyz=\"1 0 0\"/>",
        &["\"j1\"", "the first is read"],
    ),
];

fn torque(robot: &Robot) -> Vec<u64> {
    let n = robot.joints.len();
    let x = |scale: f64| (0..n).map(|i| scale * (1.0 + i as f64).sin()).collect::<Vec<_>>();
    let mut tau = vec![0.0; n];
    let mut workspace = Workspace::new(&robot.model);
    robot.model.inverse_dynamics(&mut workspace, &x(0.7), &x(1.1), &x(-2.3), &mut tau);
    tau.iter().map(|tau| tau.to_bits()).collect()
}

#[test]
fn a_quirk_is_read_as_what_was_meant_and_said() {
    let right = tower(&["revolute", "revolute"]);
    let meant = Robot::from_text(&right, None, "right").unwrap();
    assert!(meant.warnings.is_empty());
    for (written, instead, clues) in QUIRKS {
        let odd = right.replacen(written, instead, 1);
        assert_ne!(odd, right, "{written}");
        let robot = Robot::from_text(&odd, None, "odd").unwrap();
        assert_eq!(torque(&robot), torque(&meant), "{instead}");
        assert_eq!(robot.joints[0].position, Some((-0.5, 0.25)), "{instead}");
        let [warning] = &robot.warnings[..] else { panic!("{:?}", robot.warnings) };
        assert!(clues.iter().all(|clue| warning.contains(clue)), "{clues:?} in: {warning}");
    }
}

#[test]
fn what_a_file_says_is_told_without_what_a_terminal_obeys() {
    let text = tower(&["revolute"]).replacen("0.07 0 -0.69", "$(optenv a&#x7f; 0.07 0 -0.69)", 1);
    let robot = Robot::from_text(&text, None, "bell").unwrap();
    let [told] = &robot.warnings[..] else { panic!("{:?}", robot.warnings) };
    assert!(told.contains(r"a\u{7f}") && !told.contains('\u{7f}'), "{told}");
}

#[test]
fn what_stands_behind_the_end_of_a_c_string_is_no_part_of_it() {
    // Bullet's humanoid.
    let text = tower(&["revolute"]);
    let robot = Robot::from_text(&format!("{text}\0"), None, "nul").unwrap();
    assert_eq!(torque(&robot), torque(&Robot::from_text(&text, None, "plain").unwrap()));
    let inside = text.replacen("l1", "l\0", 1);
    assert!(Robot::from_text(&inside, None, "nul").unwrap_err().to_string().contains("nul:3"));
}

#[test]
fn inertia_that_no_body_has_matters_where_something_moves_it() {
    // PAL's TIAGo has an antenna that is none.
    let text = tower(&["fixed", "revolute"]);
    let none = |link: &str| {
        let (before, after) = text.split_once(&format!("<link name=\"{link}\">")).unwrap();
        format!("{before}<link name=\"{link}\">{}", after.replacen("0.001", "0.5", 1))
    };
    let robot = Robot::from_text(&none("l1"), None, "antenna").unwrap();
    assert_eq!(torque(&robot), torque(&Robot::from_text(&text, None, "plain").unwrap()));
    let [told] = &robot.warnings[..] else { panic!("{:?}", robot.warnings) };
    assert!(told.contains("antenna:3: link \"l1\"") && told.contains("nothing moves it"), "{told}");
    let why = Robot::from_text(&none("l2"), None, "antenna").unwrap_err().to_string();
    assert!(why.contains("link \"l2\"") && why.contains("products of inertia"), "{why}");
}

#[test]
fn what_no_drive_moves_is_held_outside_of_the_arm_and_refused_within() {
    for kind in ["spherical", "floating", "planar"] {
        // Before the arm and after it: fixed, and said.
        let text = tower(&[kind, "revolute", "revolute", kind]);
        let fixed = tower(&["fixed", "revolute", "revolute", "fixed"]);
        let robot = Robot::from_text(&text, None, "ball").unwrap();
        assert_eq!(torque(&robot), torque(&Robot::from_text(&fixed, None, "fixed").unwrap()));
        let told: Vec<&str> = robot.warnings.iter().map(String::as_str).collect();
        assert_eq!(told, [1, 4].map(|k| format!("joint \"j{k}\": {kind}, held fixed")), "{kind}");
        // Between: no arm, but one on either side of it.
        let text = tower(&["revolute", kind, "revolute", "revolute"]);
        let why = Robot::from_text(&text, None, "ball").unwrap_err().to_string();
        let clues = ["ball:8: joint \"j2\"", kind, "\"j3\" is behind it", "name a base and a tip"];
        assert!(clues.iter().all(|clue| why.contains(clue)), "{why}");
        let chains = Robot::chains_of_text(&text, "ball").unwrap();
        let joints: Vec<_> = chains.iter().map(|chain| chain.joints.join(" ")).collect();
        assert_eq!(joints, ["j3 j4", "j1"]);
        for chain in chains {
            let part = Part { base: Some(chain.base), tip: Some(chain.tip), ..Part::default() };
            let robot = Robot::part_of_text(&text, &part, "ball").unwrap();
            assert_eq!(robot.model.joint_names(), chain.joints);
        }
        // Nothing else: no arm at all.
        let why = Robot::from_text(&tower(&[kind]), None, "ball").unwrap_err().to_string();
        assert!(why.contains(&format!("\"j1\" is {kind}")) && why.contains("revolute"), "{why}");
    }
}

#[test]
fn what_is_held_is_told_with_its_place() {
    let text = tower(&["revolute", "prismatic", "revolute", "fixed"]);
    let part = Part {
        base: Some("l2".to_owned()),
        tip: Some("l4".to_owned()),
        locked: [("j1".to_owned(), 0.2)].into(),
        ..Part::default()
    };
    let robot = Robot::part_of_text(&text, &part, "held").unwrap();
    assert_eq!(robot.held, [("j1".to_owned(), 0.2), ("j2".to_owned(), 0.0)].into());
    let whole = Robot::from_text(&text, None, "held").unwrap();
    assert!(whole.held.is_empty());
    let locked = whole.lock(&[("j3".to_owned(), -0.1)]).unwrap();
    assert_eq!(locked.held, [("j3".to_owned(), -0.1)].into());
}

/// Replacement of the limits in the first joint; its torque limit, speed limit and travel as read; words of the
/// warning.
type OddLimit =
    (&'static str, (Option<f64>, Option<f64>, Option<(f64, f64)>), &'static [&'static str]);

/// The travel of the tower's joints.
const TRAVEL: Option<(f64, f64)> = Some((-0.5, 0.25));

const ODD_LIMITS: &[OddLimit] = &[
    // Annin's AR4, Halodi's EVE.
    ("effort=\"-1\" velocity=\"2\"", (None, Some(2.0), TRAVEL), &["effort limit -1", "none"]),
    ("effort=\"9\" velocity=\"-1\"", (Some(9.0), None, TRAVEL), &["velocity limit -1", "none"]),
    ("effort=\"inf\" velocity=\"2\"", (None, Some(2.0), TRAVEL), &["effort", "inf", "none"]),
    (
        "effort=\"999999\" velocity=\"2\"",
        (None, Some(2.0), TRAVEL),
        &["effort", "9.99999e5", "none"],
    ),
    // A speed in degrees is read as it stands, and doubted.
    ("effort=\"9\" velocity=\"180\"", (Some(9.0), Some(180.0), TRAVEL), &["(line 5)", "3.141593"]),
];

#[test]
fn limits_that_mean_none_are_read_as_none_and_units_are_doubted() {
    let right = tower(&["revolute", "revolute"]);
    for (instead, (torque_max, velocity_max, position), clues) in ODD_LIMITS {
        let odd = right.replacen("effort=\"9\" velocity=\"2\"", instead, 1);
        let robot = Robot::from_text(&odd, None, "odd").unwrap();
        let joint = &robot.joints[0];
        assert_eq!(
            (joint.torque_max, joint.velocity_max),
            (*torque_max, *velocity_max),
            "{instead}"
        );
        assert_eq!(joint.position, *position, "{instead}");
        let [warning] = &robot.warnings[..] else { panic!("{:?}", robot.warnings) };
        assert!(clues.iter().all(|clue| warning.contains(clue)), "{clues:?} in: {warning}");
    }
    let travel = "lower=\"-0.5\" upper=\"0.25\"";
    for (instead, position, clues) in [
        ("lower=\"-inf\" upper=\"inf\"", None, ["-inf … inf", "without end"]),
        ("lower=\"-999999\" upper=\"999999\"", None, ["999999", "without end"]),
        (
            "lower=\"-170\" upper=\"170\"",
            Some((-170.0, 170.0)),
            ["54.1 turns", "lower=\"-2.967060\""],
        ),
    ] {
        let robot = Robot::from_text(&right.replacen(travel, instead, 1), None, "odd").unwrap();
        assert_eq!(robot.joints[0].position, position, "{instead}");
        let [warning] = &robot.warnings[..] else { panic!("{:?}", robot.warnings) };
        assert!(clues.iter().all(|clue| warning.contains(clue)), "{clues:?} in: {warning}");
    }
    // A number below 0 that nobody writes for none may be a slip.
    let odd = right.replacen("effort=\"9\"", "effort=\"-87\"", 1);
    let why = Robot::from_text(&odd, None, "odd").unwrap_err().to_string();
    assert!(why.contains("odd:5") && why.contains("write 0 or -1"), "{why}");
}

#[test]
fn inertia_and_centre_in_other_units_are_read_and_doubted() {
    let right = tower(&["revolute"]);
    // sqrt(0.03e6 / 1.5) m, and 120 m.
    for (written, instead, clues) in [
        ("iyy=\"0.03\"", "iyy=\"30000\"", ["gyration of 141.421 m", "kg·mm², divide by 1e6"]),
        ("0.02 -0.01 0.1", "0 0 120", ["120.000 m from the link's frame", "divide by 1000"]),
    ] {
        let robot = Robot::from_text(&right.replacen(written, instead, 1), None, "odd").unwrap();
        let told = |warning: &&String| clues.iter().all(|clue| warning.contains(clue));
        let [warning] = robot.warnings.iter().filter(told).collect::<Vec<_>>()[..] else {
            panic!("{:?}", robot.warnings)
        };
        assert!(warning.contains("link \"l1\" (line 3)"), "{warning}");
    }
}

#[test]
fn properties_of_xacro_that_nothing_uses_are_left_out() {
    let right = tower(&["revolute"]);
    let plain = torque(&Robot::from_text(&right, None, "plain").unwrap());
    for open in [
        "<robot name=\"tower\">",
        "<robot name=\"tower\" xmlns:xacro=\"http://ros.org/wiki/xacro\">",
    ] {
        let property = format!("{open}<xacro:property name=\"pi\" value=\"3.14\"/>");
        let text = right.replacen("<robot name=\"tower\">", &property, 1);
        assert_eq!(torque(&Robot::from_text(&text, None, "unused").unwrap()), plain);
        let text = text.replacen("value=\"1.5\"", "value=\"${pi}\"", 1);
        let why = Robot::from_text(&text, None, "used").unwrap_err().to_string();
        assert!(why.contains("xacro") && why.contains("expand it first"), "{why}");
    }
}

#[test]
fn usd_is_named() {
    let folder = std::env::temp_dir().join(format!("phihat-usd-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (name, bytes) in
        [("arm.usda", &b"#usda 1.0\n"[..]), ("arm.usd", b"PXR-USDC\0\0\x01\x02\xff\xfe")]
    {
        let file = folder.join(name);
        std::fs::write(&file, bytes).unwrap();
        for why in [Robot::read(&file).map(|_| ()), Robot::chains(&file).map(|_| ())] {
            let why = why.unwrap_err().to_string();
            assert!(
                why.contains(name) && why.contains("this is USD") && why.contains("URDF"),
                "{why}"
            );
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
