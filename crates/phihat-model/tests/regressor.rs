//! Torque is linear in the dynamic parameters: `Y π = τ`. Wrong if a column belongs to another
//! parameter.

use crate::support::{Random, models, relative_error, times};
use phihat_model::{Body, Workspace};

#[test]
fn times_the_parameters_it_is_inverse_dynamics() {
    let mut random = Random(12);
    for model in models() {
        let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
        for _ in 0..20 {
            let (q, dq, ddq) =
                (random.vector(n, 3.0), random.vector(n, 2.0), random.vector(n, 5.0));
            let (mut y, mut tau) = (vec![0.0; 10 * n * n], vec![0.0; n]);
            model.regressor(&mut ws, &q, &dq, &ddq, &mut y);
            model.inverse_dynamics(&mut ws, &q, &dq, &ddq, &mut tau);
            let parameters = model.dynamic_parameters();
            assert!(relative_error(&times(&y, parameters.as_flattened()), &tau) < 1e-12);
        }
    }
}

#[test]
fn it_does_not_depend_on_the_parameters() {
    let model = phihat_model::Robot::named("panda").unwrap().model;
    let frame = model.frame("panda_link4").unwrap();
    let body = Body { mass: 3.0, com: [0.1, 0.2, 0.3], inertia: [0.1, 0.0, 0.0, 0.1, 0.0, 0.1] };
    let other = model.clone().with_payload(frame, &body).unwrap();
    let x = [0.3, -0.2, 0.5, -1.2, 0.9, 1.1, -0.4];
    let [mut y, mut y_other] = [vec![0.0; 490], vec![0.0; 490]];
    model.regressor(&mut Workspace::new(&model), &x, &x, &x, &mut y);
    other.regressor(&mut Workspace::new(&other), &x, &x, &x, &mut y_other);
    assert_eq!(y, y_other);
}
