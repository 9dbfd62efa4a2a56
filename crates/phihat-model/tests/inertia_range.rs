//! The inertia's range over the postures is that of the arm.

use phihat_model::Robot;

#[test]
fn ratios_are_those_of_the_arms_readme() {
    // `robots/README.md`, 1500 postures with another generator: extremes differ by a few percent.
    for (name, ratio) in [("panda", 8.8), ("iiwa14", 9.4), ("ur5", 16.0), ("planar3r", 5.4)] {
        let range = Robot::named(name).unwrap().inertia_range(1500, 1);
        assert!((range.ratio() / ratio - 1.0).abs() < 0.12, "{name}: {}", range.ratio());
        assert!(range.lambda_min < 1.0 && range.lambda_max > 1.0);
    }
}

#[test]
fn the_mean_lies_between_the_extremes_and_the_seed_decides_all() {
    let robot = Robot::named("panda").unwrap();
    let range = robot.inertia_range(200, 7);
    for i in 0..7 {
        assert!(range.min[i] <= range.mean[i] && range.mean[i] <= range.max[i]);
        assert!(range.min[i] >= robot.joints[i].armature);
    }
    assert_eq!(range, robot.inertia_range(200, 7));
    assert_ne!(range, robot.inertia_range(200, 8));
}

#[test]
fn eigenvalues_of_a_two_joint_arm_are_those_of_its_formula() {
    // The last two joints of planar3r, far from gravity's reach: λ of a 2 × 2 matrix in closed form.
    let robot = Robot::named("planar3r").unwrap().lock(&[("joint1".to_owned(), 0.0)]).unwrap();
    let range = robot.inertia_range(1, 3);
    // One posture: M̄ is its diagonal, so the eigenvalues are 1 ± ρ and sum up to 2.
    assert!((range.lambda_min + range.lambda_max - 2.0).abs() < 1e-14);
}
