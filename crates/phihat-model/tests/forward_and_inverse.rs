//! Forward dynamics undoes inverse dynamics, armature and trees included. Wrong if the two sweeps
//! disagree about any term.

use crate::support::{Random, models, relative_error};
use phihat_model::Workspace;

#[test]
fn torque_of_an_acceleration_causes_that_acceleration() {
    let mut random = Random(7);
    for model in models() {
        let n = model.joint_count();
        let armature: Vec<f64> = (0..n).map(|_| random.within(0.0, 0.3)).collect();
        for model in [model.clone(), model.with_armature(&armature).unwrap()] {
            let mut ws = Workspace::new(&model);
            for _ in 0..50 {
                let (q, dq) = (random.vector(n, 3.0), random.vector(n, 2.0));
                let wanted = random.vector(n, 10.0);
                let (mut tau, mut ddq) = (vec![0.0; n], vec![0.0; n]);
                model.inverse_dynamics(&mut ws, &q, &dq, &wanted, &mut tau);
                model.forward_dynamics(&mut ws, &q, &dq, &tau, &mut ddq);
                // Rounding grows with the condition of M, up to 4300 for these arms.
                assert!(relative_error(&ddq, &wanted) < 1e-9);
            }
        }
    }
}
