//! The Jacobian is the derivative of the pose, for every frame. Wrong if a column's axis or arm is.

use crate::support::{Random, models, relative_error};
use phihat_model::Workspace;

#[test]
fn it_is_the_derivative_of_the_pose() {
    let mut random = Random(13);
    for model in models() {
        let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
        let q = random.vector(n, 2.0);
        for name in model.frame_names() {
            let frame = model.frame(name).unwrap();
            let mut jacobian = vec![0.0; 6 * n];
            model.jacobian(&mut ws, &q, frame, &mut jacobian);
            let r = model.pose(&ws, frame).r;
            let mut differences = vec![0.0; 6 * n];
            for joint in 0..n {
                let mut at = |t: f64| {
                    let mut q = q.clone();
                    q[joint] += t;
                    model.forward_kinematics(&mut ws, &q);
                    model.pose(&ws, frame)
                };
                let h = 1e-6;
                let (ahead, behind) = (at(h), at(-h));
                for k in 0..3 {
                    differences[k * n + joint] = (ahead.p[k] - behind.p[k]) / (2.0 * h);
                    // Ṙ Rᵀ = [ω×]
                    let (a, b) = ((k + 2) % 3, (k + 1) % 3);
                    let entry = |x: usize, y: usize| -> f64 {
                        (0..3).map(|c| (ahead.r[x][c] - behind.r[x][c]) * r[y][c]).sum()
                    };
                    differences[(3 + k) * n + joint] = (entry(a, b) - entry(b, a)) / (4.0 * h);
                }
            }
            let error = relative_error(&differences, &jacobian);
            assert!(error < 1e-8, "{name}: {error}");
            let moves = jacobian.iter().any(|x| x.abs() > 0.0);
            assert!(!moves || error > 0.0, "{name}: compared with itself");
        }
    }
}
