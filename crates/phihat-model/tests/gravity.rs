//! Gravity's torque is the gradient of the potential energy, on the ground, on a wall and nowhere.

use crate::support::{Random, models, relative_error};
use phihat_model::Workspace;

#[test]
fn torque_is_the_gradient_of_the_potential() {
    let mut random = Random(8);
    for model in models() {
        for gravity in [[0.0, 0.0, -9.81], [6.0, -7.0, 2.0]] {
            let model = model.clone().with_gravity(gravity);
            let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
            let q = random.vector(n, 2.0);
            let mut tau = vec![0.0; n];
            model.gravity_torque(&mut ws, &q, &mut tau);
            let mut slope = |joint: usize| {
                let mut at = |t: f64| {
                    let mut q = q.clone();
                    q[joint] += t;
                    model.potential_energy(&mut ws, &q)
                };
                (at(1e-5) - at(-1e-5)) / 2e-5
            };
            let gradient: Vec<f64> = (0..n).map(&mut slope).collect();
            assert!(relative_error(&gradient, &tau) < 1e-8);
            assert!(relative_error(&gradient, &tau) > 0.0, "compared with itself");
        }
    }
}

#[test]
fn nothing_falls_without_gravity() {
    for model in models() {
        let model = model.with_gravity([0.0; 3]);
        let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
        let mut tau = vec![1.0_f64; n];
        model.gravity_torque(&mut ws, &vec![0.7; n], &mut tau);
        assert!(tau.iter().all(|tau| tau.abs() <= 0.0));
    }
}

#[test]
fn bias_at_rest_is_gravity() {
    let mut random = Random(9);
    for model in models() {
        let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
        let q = random.vector(n, 2.0);
        let (mut bias, mut gravity) = (vec![0.0; n], vec![0.0; n]);
        model.bias(&mut ws, &q, &vec![0.0; n], &mut bias);
        model.gravity_torque(&mut ws, &q, &mut gravity);
        assert!(relative_error(&bias, &gravity) < 1e-12);
    }
}
