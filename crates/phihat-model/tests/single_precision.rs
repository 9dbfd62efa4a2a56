//! The same algorithms in `f32` agree with `f64` to single precision.

use crate::support::{Random, relative_error};
use phihat_model::{Robot, Workspace};

#[test]
fn single_precision_agrees_with_double() {
    let mut random = Random(18);
    for robot in crate::support::robots() {
        let model: phihat_model::Model = robot.plant_model();
        let n = model.joint_count();
        let (mut double, mut single) =
            (Workspace::<f64>::new(&model), Workspace::<f32>::new(&model));
        for _ in 0..50 {
            // Inputs that single precision holds exactly.
            let mut draw = || -> Vec<f32> {
                (0..n)
                    .map(|_| <f32 as phihat_model::Scalar>::splat(random.within(-2.0, 2.0)))
                    .collect()
            };
            let (q, dq, ddq) = (draw(), draw(), draw());
            let wide = |x: &[f32]| -> Vec<f64> { x.iter().copied().map(f64::from).collect() };
            let (mut tau, mut expected) = (vec![0.0_f32; n], vec![0.0; n]);
            model.inverse_dynamics(&mut single, &q, &dq, &ddq, &mut tau);
            model.inverse_dynamics(&mut double, &wide(&q), &wide(&dq), &wide(&ddq), &mut expected);
            assert!(relative_error(&wide(&tau), &expected) < 1e-4);
            model.forward_dynamics(&mut single, &q, &dq, &ddq, &mut tau);
            model.forward_dynamics(&mut double, &wide(&q), &wide(&dq), &wide(&ddq), &mut expected);
            assert!(relative_error(&wide(&tau), &expected) < 1e-4, "{}", robot.name);
            let (mut m, mut m_expected) = (vec![0.0_f32; n * n], vec![0.0; n * n]);
            model.mass_matrix(&mut single, &q, &mut m);
            model.mass_matrix(&mut double, &wide(&q), &mut m_expected);
            assert!(relative_error(&wide(&m), &m_expected) < 1e-4);
        }
    }
    assert_eq!(Robot::names().len(), 4);
}
