//! The built-in arms and the TOML beside a URDF.

use phihat_model::{JointKind, Robot, RobotError};

#[test]
fn built_in_arms_carry_what_their_files_say() {
    assert_eq!(Robot::names(), ["planar3r", "panda", "iiwa14", "ur5"]);
    for (name, joints) in [("planar3r", 3), ("panda", 7), ("iiwa14", 7), ("ur5", 6)] {
        let robot = Robot::named(name).unwrap();
        assert_eq!(robot.name, name);
        assert_eq!(robot.joints.len(), joints);
        assert!(robot.model.frame(&robot.tip).is_some());
        assert!(robot.sources.contains_key("rotor"));
        assert!(robot.joints.iter().all(|joint| joint.armature > 0.0));
        assert!(robot.poses["ready"].len() == joints);
    }
    let panda = Robot::named("panda").unwrap();
    let joint = &panda.joints[6];
    assert_eq!(joint.kind, JointKind::Revolute);
    assert_eq!(joint.position, Some((-2.8973, 2.8973)));
    assert_eq!((joint.torque_max, joint.torque_rate_max), (Some(12.0), Some(1000.0)));
    assert_eq!((joint.velocity_max, joint.encoder_bits), (Some(2.61), Some(18)));
    let sigmoid = joint.friction.sigmoid.unwrap();
    assert!((sigmoid.amplitude_nm - 0.56489).abs() < 1e-12);
    assert!(sigmoid.torque(0.0).abs() < 1e-15 && sigmoid.torque(1.0) > 0.2);
    assert!(sigmoid.torque(-1.0) < -0.2);
    // The TOML file's 0 stands, not the URDF's 0.003.
    assert!(joint.friction.viscous.abs() <= 0.0);
}

#[test]
fn an_unknown_arm_is_answered_with_the_nearest() {
    let message = Robot::named("pandas").unwrap_err().to_string();
    assert!(message.contains("did you mean \"panda\"") && message.contains("ur5"), "{message}");
    assert!(!Robot::named("qqq").unwrap_err().to_string().contains("did you mean"));
}

#[test]
fn files_are_read_from_disk_by_their_path() {
    let path =
        |name: &str| std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("robots").join(name);
    let robot = Robot::read(&path("ur5.toml")).unwrap();
    assert_eq!((robot.name.as_str(), robot.tip.as_str()), ("ur5", "tool0"));
    // Named by its URDF, the arm is the same: the file beside it is read.
    let by_urdf = Robot::read(&path("ur5.urdf")).unwrap();
    assert_eq!((by_urdf.joints, by_urdf.tip), (robot.joints, robot.tip));
    let text = std::fs::read_to_string(path("ur5.urdf")).unwrap();
    let bare = Robot::from_text(&text, None, "ur5.urdf").unwrap();
    assert!(bare.joints.iter().all(|joint| joint.armature.abs() <= 0.0));
    assert_eq!(bare.joints[0].torque_max, Some(150.0));
    assert_eq!(bare.tip, "tool0");
    let missing = Robot::read(&path("ur6.toml")).unwrap_err();
    assert!(matches!(missing, RobotError::Read { .. }) && missing.to_string().contains("ur6.toml"));
}

const URDF: &str = include_str!("../robots/planar3r.urdf");

fn toml(tail: &str) -> String {
    format!(
        "name = \"x\"\ndescription = \"\"\nurdf = \"x.urdf\"\ntip = \"tool\"\nlicence = \"\"\n\
         provenance = \"\"\njoints = [\"joint3\", \"joint1\", \"joint2\"]\n{tail}"
    )
}

#[test]
fn lists_follow_the_files_own_order_of_joints() {
    let text = toml(
        "[rotor]\narmature_kg_m2 = [3, 1, 2.0]\n[friction]\nviscous_nm_s_rad = 0.5\n\
         [poses]\nhome = [0.3, 0.1, 0.2]\n[drive]\nbandwidth_hz = 40\n",
    );
    let robot = Robot::from_text(URDF, Some(&text), "x").unwrap();
    let armature: Vec<f64> = robot.joints.iter().map(|joint| joint.armature).collect();
    assert_eq!(armature, [1.0, 2.0, 3.0]);
    assert_eq!(robot.poses["home"], [0.1, 0.2, 0.3]);
    assert!(robot.joints.iter().all(|joint| (joint.friction.viscous - 0.5).abs() < 1e-15));
    assert!(robot.joints.iter().all(|joint| joint.drive_bandwidth_hz == Some(40.0)));
}

#[test]
fn what_is_wrong_in_the_toml_is_named() {
    let cases = [
        ("[rotor]\narmature_kg_m2 = [1, 2]\n", &["rotor.armature_kg_m2", "2 values"][..]),
        ("[rotor]\narmature_kg_m2 = [1, -2, 3]\n", &["armature", "-2", "joint1"]),
        ("[rotor]\narmature_kg_m2 = inf\n", &["armature", "inf"]),
        ("[rotor]\narmature = 1\n", &["armature", "line"]),
        ("[motor]\n", &["motor"]),
        ("[friction]\nsigmoid_amplitude_nm = 1\n", &["sigmoid_steepness_s_rad", "together"]),
        ("[limits]\ntorque_max_nm = 0\n", &["limits.torque_max_nm", "above 0"]),
        ("[encoder]\nbits = 18.5\n", &["encoder.bits", "18.5", "whole"]),
        ("[encoder]\nbits = 33\n", &["encoder.bits", "33"]),
        ("[drive]\nbandwidth_hz = [1, 2, 0]\n", &["drive.bandwidth_hz", "joint2"]),
        ("[poses]\nhome = [0.0, nan, 0.0]\n", &["poses.home", "joint1"]),
        ("[poses]\nhome = [0.0]\n", &["poses.home", "1 values"]),
    ];
    for (tail, clues) in cases {
        let message = Robot::from_text(URDF, Some(&toml(tail)), "x.toml").unwrap_err().to_string();
        assert!(message.starts_with("x.toml"), "{message}");
        for clue in clues {
            assert!(message.contains(clue), "{clue} is not in: {message}");
        }
    }
    for (from, to, clue) in [
        ("\"joint3\", ", "", "joint3"),
        ("\"joint3\"", "\"tool_joint\"", "tool_joint"),
        ("\"joint3\"", "\"joint1\"", "joint3"),
        ("tip = \"tool\"", "tip = \"hand\"", "hand"),
        // Alone what is needed has to be there.
        ("urdf = \"x.urdf\"\n", "", "urdf"),
    ] {
        let text = toml("").replace(from, to);
        let message = Robot::from_text(URDF, Some(&text), "x.toml").unwrap_err().to_string();
        assert!(message.contains(clue), "{clue} is not in: {message}");
    }
}

#[test]
fn the_urdf_a_toml_names_lies_beside_it() {
    let folder = std::env::temp_dir().join(format!("phihat-model-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for outside in ["../x.urdf", "/etc/passwd", ""] {
        let path = folder.join("x.toml");
        std::fs::write(&path, toml("").replace("x.urdf", outside)).unwrap();
        let message = Robot::read(&path).unwrap_err().to_string();
        assert!(message.contains("urdf: "), "{message}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
