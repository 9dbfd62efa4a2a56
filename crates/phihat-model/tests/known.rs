//! Arms known by name, hands and tool frames, on descriptions in the manner of their makers'. Wrong if an arm were
//! taken for another, if what a description states were replaced, or if a hand were a joint of the arm or lost its
//! mass.

use std::fs;
use std::path::Path;

use phihat_model::{Body, KnownArm, Part, Recognition, Robot, Workspace};

fn text(file: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/arms").join(file)).unwrap()
}

/// The chain that is proposed first, and its arm.
fn arm(urdf: &str) -> (Part, Robot) {
    let chain = Robot::chains_of_text(urdf, "arm.urdf").unwrap().into_iter().next().unwrap();
    assert_eq!(chain.tips, [""; 0]);
    let part = Part { base: Some(chain.base), tip: Some(chain.tip), ..Part::default() };
    let robot = Robot::part_of_text(urdf, &part, "arm.urdf").unwrap();
    (part, robot)
}

/// Names of the arms that it is, or could be.
fn names(robot: &Robot) -> Vec<&'static str> {
    match KnownArm::of(robot) {
        Recognition::Known(arm, _) => vec![&arm.name],
        Recognition::OneOf(arms) => arms.iter().map(|arm| &*arm.name).collect(),
        Recognition::None => Vec::new(),
    }
}

fn is(urdf: &str) -> Vec<&'static str> {
    names(&arm(urdf).1)
}

#[test]
fn an_arm_is_recognised_by_its_names_and_no_other_is() {
    let (fr3, ur, gen3) =
        (text("fr3_hand.urdf"), text("ur5e_gripper.urdf"), text("gen3_camera.urdf"));
    assert_eq!(is(&fr3), ["fr3"]);
    assert_eq!(
        is(&fr3.replace("fr3_", "left_fr3v2_").replace("name=\"fr3\"", "name=\"cell\"")),
        ["fr3"]
    );
    assert_eq!(
        is(&fr3.replace("fr3_", "fer_").replace("name=\"fr3\"", "name=\"cell\"")),
        ["panda"]
    );
    assert_eq!(
        is(&fr3.replace("fr3_", "my_").replace("name=\"fr3\"", "name=\"my_fr33\"")),
        [""; 0]
    );
    assert_eq!(is(&gen3), ["gen3"]);
    assert_eq!(is(&gen3.replace("bracelet", "other")), [""; 0]);
    // Universal Robots' arms have one set of names: the mass of the upper arm says which, or the robot's name.
    assert_eq!(is(&ur), ["ur5e"]);
    assert_eq!(is(&ur.replace("8.058", "8.393")), ["ur5"]);
    let heavier = ur.replace("8.058", "9.5");
    assert_eq!(is(&heavier), ["ur3", "ur5", "ur10", "ur3e", "ur5e", "ur10e"]);
    assert_eq!(is(&heavier.replace("name=\"ur\"", "name=\"cell_ur10e\"")), ["ur10e"]);
    // The robot's name counts more than a mass.
    assert_eq!(is(&ur.replace("name=\"ur\"", "name=\"ur10e\"")), ["ur10e"]);
    let built_in = |name| names(&Robot::named(name).unwrap());
    assert_eq!(built_in("panda"), ["panda"]);
    assert_eq!(built_in("iiwa14"), ["iiwa14"]);
    assert_eq!(built_in("ur5"), ["ur5"]);
    assert_eq!(built_in("planar3r"), [""; 0]);
}

#[test]
fn what_a_description_states_stays() {
    let fr3 = text("fr3_hand.urdf");
    let arm_of = |urdf: &str| {
        let mut robot = arm(urdf).1;
        let notes = KnownArm::named("fr3").unwrap().complete(&mut robot).unwrap();
        (robot, notes)
    };
    let (robot, notes) = arm_of(&fr3);
    let torque: Vec<_> = robot.joints.iter().filter_map(|joint| joint.torque_max).collect();
    assert_eq!(
        (&*robot.profile, torque),
        ("franka", vec![87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0])
    );
    assert_eq!(notes, [""; 0]);
    assert!(robot.joints.iter().all(|joint| joint.armature > 0.2 && joint.encoder_bits.is_none()));
    assert!(robot.sources["rotor"].contains("Franka") && !robot.sources.contains_key("limits"));
    // The first joint with twice the effort and friction of its own, the second without a limit.
    let other = fr3.replacen("effort=\"87\"", "effort=\"174\"", 1).replacen(
        "friction=\"0.0\"",
        "friction=\"7\"",
        1,
    );
    let at = other.find("effort=\"87\"").unwrap();
    let other = format!("{}effort=\"0\"{}", &other[..at], &other[at + "effort=\"87\"".len()..]);
    let (robot, notes) = arm_of(&other);
    let joint = &robot.joints[0];
    assert_eq!((joint.torque_max, joint.friction.coulomb), (Some(174.0), 7.0));
    assert_eq!((robot.joints[1].torque_max, joint.friction.coulomb_range), (Some(87.0), None));
    assert!(
        notes.len() == 1 && notes[0].contains("174") && notes[0].contains("fr3_joint1"),
        "{notes:?}"
    );
    assert!(KnownArm::named("fr4").unwrap_err().to_string().contains("openarm"));
}

#[test]
fn a_hand_is_carried_and_the_payload_is_in_it() {
    for (file, tip, fixed) in [
        ("fr3_hand.urdf", "fr3_hand_tcp", vec!["fr3_finger_joint1", "fr3_finger_joint2"]),
        ("ur5e_gripper.urdf", "gripper_base", vec!["gripper_left", "gripper_right"]),
        // The last link of the file is a camera's.
        ("gen3_camera.urdf", "end_effector_link", vec![]),
    ] {
        let urdf = text(file);
        let (part, robot) = arm(&urdf);
        assert_eq!((part.tip.as_deref(), &*robot.tip), (Some(tip), tip));
        assert_eq!(robot.held.keys().collect::<Vec<_>>(), fixed);
        // Every mass of the file is in the arm, or below its first joint.
        let stated =
            urdf.split("<mass value=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
        let stated: f64 = stated.map(|mass| mass.parse::<f64>().unwrap()).sum();
        let masses: f64 = robot.model.outline().iter().map(|link| link.body.mass).sum();
        assert!((stated - masses).abs() < 1e-9, "{file}: {stated} kg, {masses} kg");
        // A payload's gravity does the work of lifting the tip: g m dz/dq, by differences.
        let payload = Body { mass: 1.0, com: [0.0; 3], inertia: [0.0; 6] };
        let loaded = robot.model.clone().with_payload_on(tip, &payload).unwrap();
        let n = robot.joints.len();
        let q: Vec<f64> = (0..n).map(|i| 0.3 + 0.2 * i as f64).collect();
        let (mut bare, mut held) = (vec![0.0; n], vec![0.0; n]);
        robot.model.gravity_torque(&mut Workspace::new(&robot.model), &q, &mut bare);
        loaded.gravity_torque(&mut Workspace::new(&loaded), &q, &mut held);
        let frame = robot.model.frame(tip).unwrap();
        let height = |q: &[f64]| {
            let mut workspace = Workspace::new(&robot.model);
            robot.model.forward_kinematics(&mut workspace, q);
            robot.model.pose(&workspace, frame).p[2]
        };
        for i in 0..n {
            let at = |by: f64| {
                height(
                    &q.iter()
                        .enumerate()
                        .map(|(j, x)| x + if i == j { by } else { 0.0 })
                        .collect::<Vec<_>>(),
                )
            };
            let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
            assert!((held[i] - bare[i] - 9.81 * slope).abs() < 2e-3, "{file}, joint {i}");
        }
    }
}

#[test]
fn a_finger_without_a_name_is_none_of_the_joints_and_two_tools_are_a_question() {
    let ur = text("ur5e_gripper.urdf");
    let start = ur.find("  <joint name=\"gripper_right\"").unwrap();
    let one = format!("{}</robot>", &ur[..start]);
    let one = one
        .replace("gripper_mount", "mount")
        .replace("gripper_left", "joint_7")
        .replace("left_pad", "link_7")
        .replace("gripper_base", "link_6b");
    let chain = |urdf: &str| Robot::chains_of_text(urdf, "arm.urdf").unwrap().swap_remove(0);
    assert_eq!(chain(&one).joints.len(), 6);
    // A quill of that length is no finger: SCARA arms have one.
    assert_eq!(chain(&one.replace("upper=\"0.04\"", "upper=\"0.2\"")).joints.len(), 7);
    let two = text("fr3_hand.urdf").replace(
        "</robot>",
        "<link name=\"probe_tcp\"/><joint name=\"probe\" type=\"fixed\"><parent link=\"fr3_link8\"/>\
         <child link=\"probe_tcp\"/></joint></robot>",
    );
    let mut tips = chain(&two).tips;
    tips.sort();
    assert_eq!(tips, ["fr3_hand_tcp", "probe_tcp"]);
}
