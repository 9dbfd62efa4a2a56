//! No call of the dynamics allocates or frees memory.

use crate::support::{Random, models};
use allocation_counter::measure;
use phihat_model::Workspace;

#[test]
fn the_dynamics_leave_the_heap_alone() {
    let mut random = Random(17);
    for model in models() {
        let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
        let (q, dq, ddq) = (random.vector(n, 2.0), random.vector(n, 2.0), random.vector(n, 2.0));
        let mut out = vec![0.0; 10 * n * n];
        let frame = model.frame_of_joint(n - 1).unwrap();
        let used = measure(|| {
            model.inverse_dynamics(&mut ws, &q, &dq, &ddq, &mut out[..n]);
            model.forward_dynamics(&mut ws, &q, &dq, &ddq, &mut out[..n]);
            model.mass_matrix(&mut ws, &q, &mut out[..n * n]);
            model.bias(&mut ws, &q, &dq, &mut out[..n]);
            model.gravity_torque(&mut ws, &q, &mut out[..n]);
            model.regressor(&mut ws, &q, &dq, &ddq, &mut out);
            model.jacobian(&mut ws, &q, frame, &mut out[..6 * n]);
            let _ = model.pose(&ws, frame);
            let _ = model.kinetic_energy(&mut ws, &q, &dq);
            let _ = model.potential_energy(&mut ws, &q);
        });
        assert_eq!(used.count_total, 0);
    }
}
