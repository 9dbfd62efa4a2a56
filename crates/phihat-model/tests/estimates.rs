//! Estimates of values that a URDF omits, and their files. Wrong if a published drive lay outside its
//! interval, if a written file did not read back as it was written, if an interval were read that is none, or
//! if a rotor between two ends made an eigenvalue of the arm's inertia lie outside of those at the ends.

use phihat_model::{Part, Robot, Rotor, Workspace, dry_friction, rotor_inertia};

/// Rotor inertia at the joint, torque limit, speed limit; sources in the module `estimate`.
const DRIVES: [(f64, f64, f64); 11] = [
    (0.605_721_456, 87.0, 2.175),
    (0.462_474_144, 87.0, 2.175),
    (0.205_544_064, 12.0, 2.61),
    // Rotor inertia times the square of the gear ratio.
    (1.321e-4 * 160.0 * 160.0, 320.0, 1.483_53),
    (1.321e-4 * 160.0 * 160.0, 176.0, 1.745_33),
    (1.321e-4 * 160.0 * 160.0, 176.0, 1.309),
    (1.321e-4 * 100.0 * 100.0, 110.0, 2.268_93),
    (4.54e-5 * 160.0 * 160.0, 40.0, 2.356_19),
    (0.489e-4 * 14.318 * 14.318, 88.0, 32.0),
    (0.489e-4 * 22.5 * 22.5, 139.0, 20.0),
    (0.068e-4 * 25.0 * 25.0, 5.0, 22.0),
];

#[test]
fn published_drives_lie_inside() {
    for (own, torque, speed) in DRIVES {
        let found = rotor_inertia(torque, Some(speed));
        assert!(found.low < found.value && found.value < found.high);
        assert!((found.low..=found.high).contains(&own), "{own} is not in {found:?}");
    }
    // Amplitudes of the Panda's identified friction over its limits.
    let (panda, limits) = (Robot::named("panda").unwrap(), [87.0, 87.0, 87.0, 87.0, 12.0, 12.0]);
    for (joint, limit) in panda.joints.iter().zip(limits) {
        let own = joint.friction.sigmoid.unwrap().amplitude_nm;
        let found = dry_friction(limit);
        assert!((found.low..=found.high).contains(&own), "{}: {own}, {found:?}", joint.name);
    }
}

fn bare(name: &str) -> (String, Robot) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("robots");
    let text = std::fs::read_to_string(folder.join(format!("{name}.urdf"))).unwrap();
    let robot = Robot::from_text(&text, None, name).unwrap();
    (text, robot)
}

#[test]
fn a_written_file_reads_back() {
    for name in Robot::names() {
        let (urdf, robot) = bare(name);
        assert!(robot.joints.iter().all(|joint| joint.armature_range.is_none()));
        let mut known = robot.estimated();
        known.poses.insert("ready".to_owned(), vec![0.25; known.joints.len()]);
        let text = known.arm_file("arm.urdf", &Part::default());
        let again = Robot::from_text(&urdf, Some(&text), "arm.toml").unwrap();
        assert_eq!(again.joints, known.joints, "{text}");
        assert_eq!(again.poses, known.poses);
        assert_eq!(
            again.sources.keys().collect::<Vec<_>>(),
            ["encoder", "friction", "limits", "profile", "rotor"]
        );
        assert!(again.has_rotor_interval());
        // What is known stays as it is.
        assert_eq!(again.clone().estimated().joints, again.joints);
        // Only the URDF's name is needed.
        let least = Robot::from_text(&urdf, Some("urdf = \"arm.urdf\""), "arm.toml").unwrap();
        assert_eq!(least.joints, bare(name).1.joints);
    }
}

#[test]
fn a_part_of_a_robot_is_written_with_its_ends() {
    let (urdf, _) = bare("panda");
    let part = Part {
        base: Some("panda_link0".to_owned()),
        tip: Some("panda_link4".to_owned()),
        ..Part::default()
    };
    let arm = Robot::part_of_text(&urdf, &part, "panda.urdf").unwrap().estimated();
    assert_eq!(arm.joints.len(), 4);
    let text = arm.arm_file("panda.urdf", &part);
    let again = Robot::from_text(&urdf, Some(&text), "arm.toml").unwrap();
    assert_eq!(again.joints, arm.joints, "{text}");
}

#[test]
fn without_a_torque_limit_nothing_is_estimated() {
    let (urdf, _) = bare("planar3r");
    let urdf = urdf.replacen("effort=\"50", "effort=\"0", 1);
    let robot = Robot::from_text(&urdf, None, "arm.urdf").unwrap();
    assert_eq!(robot.without_torque_limit(), ["joint1"]);
    let known = robot.estimated();
    assert!(known.joints[0].armature_range.is_none() && known.joints[1].armature_range.is_some());
    let text = known.arm_file("arm.urdf", &Part::default());
    assert!(text.contains("# STATE the torque limit of joint1"), "{text}");
    // What cannot be stated is there as a comment: the file reads.
    let again = Robot::from_text(&urdf, Some(&text), "arm.toml").unwrap();
    assert_eq!(again.without_torque_limit(), ["joint1"]);
}

#[test]
fn what_is_no_interval_is_refused() {
    let (urdf, _) = bare("planar3r");
    let read = |rotor: &str| {
        let text = format!("urdf = \"arm.urdf\"\n{rotor}\n");
        Robot::from_text(&urdf, Some(&text), "arm.toml")
    };
    for (rotor, words) in [
        (
            "[rotor]\narmature_min_kg_m2 = 0.3\narmature_max_kg_m2 = 0.1",
            "0.3 of joint \"joint1\" is above",
        ),
        (
            "[rotor]\narmature_kg_m2 = 0.4\narmature_min_kg_m2 = 0.1\narmature_max_kg_m2 = 0.3",
            "0.4 of joint \"joint1\" must be from 0.1 to 0.3",
        ),
        (
            "[transmission]\nstiffness_min_nm_rad = 2e4\nstiffness_max_nm_rad = 1e4\n\
             damping_min_nm_s_rad = 0.0\ndamping_max_nm_s_rad = 1.0",
            "above transmission.stiffness_max_nm_rad",
        ),
        (
            "[transmission]\nstiffness_min_nm_rad = 0.0\nstiffness_max_nm_rad = 1e4\n\
             damping_min_nm_s_rad = 0.0\ndamping_max_nm_s_rad = 1.0",
            "must be above 0",
        ),
        ("[rotor]\narmature_min_kg_m2 = 0.1", "rotor.armature_max_kg_m2: it comes with"),
        ("[rotor]\nsource = \"none\"", "rotor.armature_kg_m2: it is missing"),
        ("[rotor]\narmature_min_kg_m2 = -1\narmature_max_kg_m2 = 0.1", "finite and at least 0"),
        (
            "[friction]\ncoulomb_nm = 9\ncoulomb_min_nm = 0.1\ncoulomb_max_nm = 3",
            "must be from 0.1 to 3",
        ),
    ] {
        let told = read(rotor).unwrap_err().to_string();
        assert!(told.starts_with("arm.toml") && told.contains(words), "{told}");
    }
    // Without a value, the geometric middle is simulated.
    let robot = read("[rotor]\narmature_min_kg_m2 = 0.1\narmature_max_kg_m2 = 0.9").unwrap();
    assert!((robot.joints[0].armature - 0.3).abs() < 1e-12);
}

#[test]
fn what_holds_at_both_ends_holds_between_them() {
    let (_, robot) = bare("ur5");
    let robot = robot.estimated();
    let n = robot.joints.len();
    let mut dice = 7_u64;
    let mut next = || {
        dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (dice >> 11) as f64 / (1_u64 << 53) as f64
    };
    let energy = |model: &phihat_model::Model, q: &[f64], v: &[f64]| {
        model.kinetic_energy(&mut Workspace::new(model), q, v)
    };
    let (least, most) = (robot.plant_model_at(Rotor::Least), robot.plant_model_at(Rotor::Most));
    for _ in 0..50 {
        let mut between = robot.clone();
        for joint in &mut between.joints {
            let (low, high) = joint.armature_range.unwrap();
            joint.armature = low + (high - low) * next();
        }
        let model = between.plant_model();
        let q: Vec<f64> = (0..n).map(|_| 6.0 * next() - 3.0).collect();
        let v: Vec<f64> = (0..n).map(|_| next() - 0.5).collect();
        // vᵀ M v is ordered for every v: the Loewner order.
        let own = energy(&model, &q, &v);
        assert!(energy(&least, &q, &v) <= own && own <= energy(&most, &q, &v));
    }
}
