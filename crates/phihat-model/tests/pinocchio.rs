//! Every algorithm agrees with Pinocchio 4.1.0 on every sample of every arm. Wrong if a placement,
//! a sign or an axis anywhere differs from the URDF's meaning.

use std::collections::BTreeMap;

use crate::support::{numbers, oracle, relative_error};
use phihat_model::{Robot, Workspace};

/// The oracle's own disagreement between four libraries is 1e-14 to 3e-14.
/// iiwa14 at rest needs 5e-13: its gravity torques there are small differences.
const TOLERANCE: f64 = 1e-12;

#[test]
fn every_sample_of_every_arm_agrees() {
    for name in Robot::names() {
        let errors = largest_errors(name);
        for (algorithm, error) in errors {
            println!("{name:9} {algorithm:17} {error:.1e}");
            assert!(error < TOLERANCE, "{name}: {algorithm} is off by {error:.3e}");
        }
    }
}

fn largest_errors(name: &str) -> BTreeMap<&'static str, f64> {
    let oracle = oracle(name);
    let model = Robot::named(name).expect("a built-in arm").model;
    let n = model.joint_count();
    let joints: Vec<&str> =
        oracle["joints"].as_array().unwrap().iter().filter_map(|j| j.as_str()).collect();
    assert_eq!(model.joint_names(), joints);
    let tip = model.frame(oracle["tip_frame"].as_str().unwrap()).expect("the tip");
    let last = model.frame_of_joint(n - 1).expect("the last joint's link");
    let mut ws = Workspace::new(&model);
    let mut errors = BTreeMap::new();
    let mut note = |what: &'static str, found: &[f64], expected: &serde_json::Value| {
        let error = relative_error(found, &numbers(expected));
        let largest = errors.entry(what).or_insert(0.0_f64);
        *largest = largest.max(error);
    };
    for (body, parameters) in
        oracle["lumped_bodies"].as_array().unwrap().iter().zip(model.dynamic_parameters())
    {
        note("parameters", &parameters, &body["dynamic_parameters"]);
    }
    let samples = oracle["samples"].as_array().unwrap();
    assert_eq!(samples.len(), 200);
    for sample in samples {
        let input = |key: &str| numbers(&sample[key]);
        let (q, dq, ddq, tau) = (input("q"), input("qd"), input("qdd"), input("tau"));
        let mut out = vec![0.0; n];
        model.inverse_dynamics(&mut ws, &q, &dq, &ddq, &mut out);
        note("inverse_dynamics", &out, &sample["rnea"]);
        model.forward_dynamics(&mut ws, &q, &dq, &tau, &mut out);
        note("forward_dynamics", &out, &sample["aba"]);
        model.bias(&mut ws, &q, &dq, &mut out);
        note("bias", &out, &sample["nle"]);
        model.gravity_torque(&mut ws, &q, &mut out);
        note("gravity_torque", &out, &sample["gravity"]);
        let mut matrix = vec![0.0; n * n];
        model.mass_matrix(&mut ws, &q, &mut matrix);
        note("mass_matrix", &matrix, &sample["crba"]);
        let kinetic = model.kinetic_energy(&mut ws, &q, &dq);
        note("kinetic_energy", &[kinetic], &sample["kinetic"]);
        let potential = model.potential_energy(&mut ws, &q);
        note("potential_energy", &[potential], &sample["potential"]);
        let mut jacobian = vec![0.0; 6 * n];
        model.jacobian(&mut ws, &q, tip, &mut jacobian);
        note("jacobian", &jacobian, &sample["tip_jacobian"]);
        for (frame, p, r) in
            [(tip, "tip_pos", "tip_rot"), (last, "last_joint_pos", "last_joint_rot")]
        {
            let pose = model.pose(&ws, frame);
            note("pose (position)", &pose.p, &sample[p]);
            note("pose (rotation)", pose.r.as_flattened(), &sample[r]);
        }
        if let Some(expected) = sample.get("regressor").filter(|y| y.is_array()) {
            let mut y = vec![0.0; 10 * n * n];
            model.regressor(&mut ws, &q, &dq, &ddq, &mut y);
            note("regressor", &y, expected);
        }
    }
    errors
}
