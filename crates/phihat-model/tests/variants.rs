//! A locked joint is a fixed joint, a payload is a heavier link, armature is added to the diagonal:
//! each against the description written that way.

use crate::support::{Random, inertial, joint, link, mass_matrix, model_of, relative_error, tree};
use phihat_model::{Body, Model, Robot, RobotError, Workspace};

fn torque(model: &Model, q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
    let mut tau = vec![0.0; q.len()];
    model.inverse_dynamics(&mut Workspace::new(model), q, dq, ddq, &mut tau);
    tau
}

#[test]
fn a_locked_joint_moves_like_the_whole_arm_with_that_joint_still() {
    let mut random = Random(15);
    for robot in crate::support::robots() {
        let n = robot.model.joint_count();
        let lock = n / 2;
        let (low, high) = robot.joints[lock].position.unwrap();
        let at = random.within(low, high);
        let locked = robot.clone().lock(&[(robot.joints[lock].name.clone(), at)]).unwrap();
        assert_eq!(locked.model.joint_count(), n - 1);
        assert!(locked.joints.iter().all(|joint| joint.name != robot.joints[lock].name));
        let without =
            |x: &[f64]| -> Vec<f64> { (0..n).filter(|k| *k != lock).map(|k| x[k]).collect() };
        let (mut q, mut dq, mut ddq) =
            (random.vector(n, 2.0), random.vector(n, 2.0), random.vector(n, 2.0));
        (q[lock], dq[lock], ddq[lock]) = (at, 0.0, 0.0);
        let expected = without(&torque(&robot.model, &q, &dq, &ddq));
        let found = torque(&locked.model, &without(&q), &without(&dq), &without(&ddq));
        assert!(relative_error(&found, &expected) < 1e-12);
        let tip = |model: &Model, q: &[f64]| {
            let mut ws = Workspace::new(model);
            model.forward_kinematics(&mut ws, q);
            model.pose(&ws, model.frame(&robot.tip).unwrap()).p
        };
        assert!(relative_error(&tip(&locked.model, &without(&q)), &tip(&robot.model, &q)) < 1e-12);
        assert!(locked.poses.values().all(|pose| pose.len() == n - 1));
    }
}

#[test]
fn locking_refuses_what_is_not_there_or_out_of_reach() {
    let panda = || Robot::named("panda").unwrap();
    let lock = |name: &str, at: f64| panda().lock(&[(name.to_owned(), at)]).unwrap_err();
    let message = lock("panda_joint9", 0.0).to_string();
    assert!(message.contains("panda_joint9") && message.contains("panda_joint1"), "{message}");
    let message = lock("panda_joint4", 0.5).to_string();
    assert!(message.contains("0.5") && message.contains("-0.0698"), "{message}");
    assert!(matches!(lock("panda_joint4", f64::NAN), RobotError::Lock { .. }));
    let all: Vec<(String, f64)> =
        panda().joints.iter().map(|j| (j.name.clone(), j.position.unwrap().0)).collect();
    assert!(panda().lock(&all).unwrap_err().to_string().contains("last that moves"));
}

#[test]
fn a_payload_is_a_heavier_link() {
    let tree = tree(5, 6, true);
    let n = tree.model.joint_count();
    let (name, mass, com, inertia) = &tree.bodies[n / 2];
    // Doubling a link: a payload equal to it.
    let body = Body { mass: *mass, com: *com, inertia: *inertia };
    let loaded = tree.model.clone().with_payload(tree.model.frame(name).unwrap(), &body).unwrap();
    let plain = inertial(*mass, *com, *inertia);
    let double = inertial(2.0 * mass, *com, inertia.map(|x| 2.0 * x));
    let start = tree.urdf.find(&format!("<link name=\"{name}\">")).unwrap();
    let mass_at = tree.urdf[start..].find(&format!("<mass value=\"{mass}\"/>")).unwrap() + start;
    assert!(mass_at > start && plain.len() > 10);
    let end = tree.urdf[start..].find("</link>").unwrap() + start;
    let urdf =
        format!("{}<link name=\"{name}\">{double}{}", &tree.urdf[..start], &tree.urdf[end..]);
    let written = Robot::from_text(&urdf, None, "double").unwrap().model;
    let mut random = Random(16);
    let (q, dq, ddq) = (random.vector(n, 2.0), random.vector(n, 2.0), random.vector(n, 2.0));
    let expected = torque(&written, &q, &dq, &ddq);
    assert!(relative_error(&torque(&loaded, &q, &dq, &ddq), &expected) < 1e-12);
    assert!(relative_error(&torque(&tree.model, &q, &dq, &ddq), &expected) > 1e-6);
}

#[test]
fn a_payload_no_body_has_is_refused() {
    let model = Robot::named("panda").unwrap().model;
    let tip = model.frame("panda_link8").unwrap();
    let body = Body { mass: 1.0, com: [0.0; 3], inertia: [0.1, 0.0, 0.0, 0.1, 0.0, 0.1] };
    for bad in [
        Body { mass: -1.0, ..body },
        Body { mass: f64::NAN, ..body },
        Body { com: [f64::INFINITY, 0.0, 0.0], ..body },
        Body { inertia: [0.1, 0.2, 0.0, 0.1, 0.0, 0.1], ..body },
    ] {
        let message = model.clone().with_payload(tip, &bad).unwrap_err().to_string();
        assert!(message.contains("panda_link8"), "{message}");
    }
}

#[test]
fn armature_is_added_to_the_diagonal_and_nowhere_else() {
    let robot = Robot::named("panda").unwrap();
    let (plant, n) = (robot.plant_model(), 7);
    let q = &robot.poses["ready"];
    let mut expected = mass_matrix(&robot.model, &mut Workspace::new(&robot.model), q);
    for joint in 0..n {
        expected[joint * n + joint] += robot.joints[joint].armature;
    }
    assert_eq!(mass_matrix(&plant, &mut Workspace::new(&plant), q), expected);
    assert!(robot.model.armature().iter().all(|x| x.abs() <= 0.0));
    let zero = vec![0.0; n];
    assert_eq!(torque(&plant, q, q, &zero), torque(&robot.model, q, q, &zero));
    for bad in [vec![0.1; 6], vec![-0.1; 7], vec![f64::NAN; 7]] {
        assert!(robot.model.clone().with_armature(&bad).is_err());
    }
}

#[test]
fn two_arms_on_one_base_do_not_feel_each_other() {
    let body = |m: f64| inertial(m, [0.1, 0.2, 0.3], [0.05, 0.0, 0.0, 0.06, 0.0, 0.07]);
    let arm = |side: &str, place: &str, m: f64| {
        let name = |k: usize| format!("{side}{k}");
        vec![
            link(&name(1), &body(m)),
            link(&name(2), &body(m + 1.0)),
            joint(&format!("{side}a"), "revolute", ["base", &name(1)], place, "1 2 3"),
            joint(&format!("{side}b"), "revolute", [&name(1), &name(2)], "0.3 0.1 0", "0 1 0"),
        ]
    };
    let base = || vec![link("base", "")];
    let (left, right) = (arm("left", "0 1 0", 2.0), arm("right", "0.2 -1 0.5", 3.0));
    let both = model_of(&[base(), left.clone(), right.clone()].concat());
    let (left, right) = (model_of(&[base(), left].concat()), model_of(&[base(), right].concat()));
    let x = [0.3, -0.8, 1.2, 0.4];
    let expected =
        [torque(&left, &x[..2], &x[..2], &x[..2]), torque(&right, &x[2..], &x[2..], &x[2..])];
    assert!(relative_error(&torque(&both, &x, &x, &x), &expected.concat()) < 1e-13);
    let m = mass_matrix(&both, &mut Workspace::new(&both), &x);
    for (i, j) in [(0, 2), (0, 3), (1, 2), (1, 3)] {
        assert!(m[i * 4 + j].abs() <= 0.0);
    }
}

#[test]
fn heavier_links_scale_gravity_and_leave_the_rotors() {
    let arm = Robot::named("panda").unwrap();
    let light = arm.plant_model();
    let heavy = light.clone().with_masses_times(1.7).unwrap();
    let q = [0.3, -0.4, 0.5, -1.2, 0.7, 1.1, -0.2];
    let (mut a, mut b) = ([0.0_f64; 7], [0.0_f64; 7]);
    light.gravity_torque(&mut Workspace::new(&light), &q, &mut a);
    heavy.gravity_torque(&mut Workspace::new(&heavy), &q, &mut b);
    let (mut m, mut n) = ([0.0_f64; 49], [0.0_f64; 49]);
    light.mass_matrix(&mut Workspace::new(&light), &q, &mut m);
    heavy.mass_matrix(&mut Workspace::new(&heavy), &q, &mut n);
    for i in 0..7 {
        assert!((b[i] - 1.7 * a[i]).abs() < 1e-12);
        for j in 0..7 {
            let rotor = if i == j { light.armature()[i] } else { 0.0 };
            let (links, k) = (m[7 * i + j] - rotor, 7 * i + j);
            assert!((n[k] - rotor - 1.7 * links).abs() < 1e-12);
        }
    }
    assert!(light.with_masses_times(0.0).is_err());
}

#[test]
#[should_panic(expected = "planar3r: set by hand")]
fn rotors_that_are_none_are_not_left_out_in_silence() {
    let mut robot = Robot::named("planar3r").unwrap();
    robot.joints[0].armature = f64::NAN;
    let _ = robot.plant_model();
}
