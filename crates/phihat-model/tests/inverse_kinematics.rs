//! Inverse kinematics brings the tip to poses that exist, stays inside the limits, repeats itself,
//! and says how far it missed those that do not.

use crate::support::{Random, robots};
use phihat_model::{IkError, IkOptions, PoseTarget, Robot, Workspace};

fn options(robot: &Robot) -> IkOptions {
    let turn = (-6.3, 6.3);
    let limits = robot.joints.iter().map(|joint| joint.position.unwrap_or(turn)).collect();
    IkOptions { limits, ..IkOptions::default() }
}

#[test]
fn random_reachable_poses_are_reached_inside_the_limits() {
    let mut random = Random(14);
    for robot in robots() {
        let (model, options) = (&robot.model, options(&robot));
        let (mut ws, tip) = (Workspace::new(model), model.frame(&robot.tip).unwrap());
        let draw = |random: &mut Random| -> Vec<f64> {
            options.limits.iter().map(|(low, high)| random.within(*low, *high)).collect()
        };
        let (mut reached, tries) = (0, 100);
        for _ in 0..tries {
            let (there, seed) = (draw(&mut random), draw(&mut random));
            model.forward_kinematics(&mut ws, &there);
            let pose = model.pose(&ws, tip);
            for target in [PoseTarget::Position(pose.p), PoseTarget::Pose(pose)] {
                match model.inverse_kinematics(&mut ws, tip, &target, &seed, &options) {
                    Ok(q) => {
                        model.forward_kinematics(&mut ws, &q);
                        let found = model.pose(&ws, tip);
                        let miss = (0..3).map(|k| (found.p[k] - pose.p[k]).abs()).sum::<f64>();
                        assert!(miss < 2e-9);
                        let inside =
                            q.iter().zip(&options.limits).all(|(q, l)| (l.0..=l.1).contains(q));
                        assert!(inside);
                        reached += 1;
                    }
                    Err(error) => assert!(matches!(error, IkError::NotReached { .. })),
                }
            }
        }
        println!("{}: {reached} of {}", robot.name, 2 * tries);
        assert!(reached >= 2 * tries - 4, "{}: {reached} of {}", robot.name, 2 * tries);
    }
}

#[test]
fn the_same_call_gives_the_same_bits() {
    let robot = Robot::named("panda").unwrap();
    let (model, options) = (&robot.model, options(&robot));
    let tip = model.frame(&robot.tip).unwrap();
    let target = PoseTarget::Position([0.4, 0.3, 0.5]);
    let solve = |ws: &mut Workspace| {
        model.inverse_kinematics(ws, tip, &target, &robot.poses["ready"], &options).unwrap()
    };
    let mut used = Workspace::new(model);
    let first = solve(&mut used);
    assert_eq!(first, solve(&mut used));
    assert_eq!(first, solve(&mut Workspace::new(model)));
}

#[test]
fn a_target_out_of_reach_is_missed_by_what_is_missing() {
    // Straight out the arm reaches 0.305 + 0.208 + 0.370 m; the target is 2 m away.
    let robot = Robot::named("planar3r").unwrap();
    let (model, options) = (&robot.model, options(&robot));
    let tip = model.frame(&robot.tip).unwrap();
    let target = PoseTarget::Position([2.0, 0.0, 0.0]);
    let mut ws = Workspace::new(model);
    let error = model.inverse_kinematics(&mut ws, tip, &target, &[0.1; 3], &options).unwrap_err();
    let IkError::NotReached { position, rotation, nearest } = error else { panic!("{error}") };
    assert!((position - (2.0 - 0.883)).abs() < 1e-6, "{position} at {nearest:?}");
    assert!(rotation.abs() <= 0.0);
}

#[test]
fn a_seed_of_another_length_is_refused() {
    let model = Robot::named("ur5").unwrap().model;
    let (tip, target) = (model.frame("tool0").unwrap(), PoseTarget::Position([0.3; 3]));
    let options = IkOptions::default();
    let error =
        model.inverse_kinematics(&mut Workspace::new(&model), tip, &target, &[0.0], &options);
    assert_eq!(error, Err(IkError::Shape { joints: 6 }));
}
