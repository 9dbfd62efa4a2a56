//! `M` is symmetric, positive definite, what inverse dynamics says column by column, and the sum
//! of every link's inertia through its Jacobian. Wrong if a composite inertia loses a body.

use crate::support::{Random, mass_matrix, models, relative_error, trees};
use phihat_model::Workspace;

#[test]
fn it_is_symmetric_and_positive_definite() {
    let mut random = Random(1);
    for model in models() {
        let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
        for _ in 0..100 {
            let m = mass_matrix(&model, &mut ws, &random.vector(n, 3.0));
            for i in 0..n {
                for j in 0..n {
                    assert_eq!(m[i * n + j].to_bits(), m[j * n + i].to_bits());
                }
            }
            assert!(smallest_pivot(m, n) > 0.0);
        }
    }
}

#[test]
fn its_columns_are_torques_of_unit_accelerations() {
    let mut random = Random(2);
    for model in models() {
        let model = model.with_gravity([0.0; 3]);
        let (n, mut ws) = (model.joint_count(), Workspace::new(&model));
        let q = random.vector(n, 3.0);
        let m = mass_matrix(&model, &mut ws, &q);
        for j in 0..n {
            let (rest, mut unit, mut tau) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
            unit[j] = 1.0;
            model.inverse_dynamics(&mut ws, &q, &rest, &unit, &mut tau);
            let column: Vec<f64> = (0..n).map(|i| m[i * n + j]).collect();
            assert!(relative_error(&column, &tau) < 1e-12);
        }
    }
}

#[test]
fn it_is_the_sum_of_all_links_through_their_jacobians() {
    let mut random = Random(3);
    for tree in trees() {
        let (model, n) = (&tree.model, tree.model.joint_count());
        let mut ws = Workspace::new(model);
        let q = random.vector(n, 2.0);
        let m = mass_matrix(model, &mut ws, &q);
        let mut sum = vec![0.0; n * n];
        for (name, mass, com, [xx, xy, xz, yy, yz, zz]) in &tree.bodies {
            let frame = model.frame(name).unwrap();
            let mut jacobian = vec![0.0; 6 * n];
            model.jacobian(&mut ws, &q, frame, &mut jacobian);
            let r = model.pose(&ws, frame).r;
            let out = |v: [f64; 3]| r.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
            let c = out(*com);
            for i in 0..n {
                for j in 0..n {
                    let part = |k: usize| {
                        let at = |row: usize| jacobian[row * n + k];
                        let (v, w) = ([at(0), at(1), at(2)], [at(3), at(4), at(5)]);
                        let turn = [
                            w[1] * c[2] - w[2] * c[1],
                            w[2] * c[0] - w[0] * c[2],
                            w[0] * c[1] - w[1] * c[0],
                        ];
                        let inward =
                            [0, 1, 2].map(|a| r[0][a] * w[0] + r[1][a] * w[1] + r[2][a] * w[2]);
                        ([v[0] + turn[0], v[1] + turn[1], v[2] + turn[2]], inward)
                    };
                    let ((vi, wi), (vj, wj)) = (part(i), part(j));
                    let spin = [
                        xx * wj[0] + xy * wj[1] + xz * wj[2],
                        xy * wj[0] + yy * wj[1] + yz * wj[2],
                        xz * wj[0] + yz * wj[1] + zz * wj[2],
                    ];
                    sum[i * n + j] +=
                        mass * crate::support::dot(&vi, &vj) + crate::support::dot(&wi, &spin);
                }
            }
        }
        assert!(relative_error(&m, &sum) < 1e-12, "{}", tree.urdf);
    }
}

fn smallest_pivot(mut m: Vec<f64>, n: usize) -> f64 {
    let mut smallest = f64::INFINITY;
    for k in 0..n {
        smallest = smallest.min(m[k * n + k]);
        for i in k + 1..n {
            let factor = m[i * n + k] / m[k * n + k];
            for j in k..n {
                m[i * n + j] -= factor * m[k * n + j];
            }
        }
    }
    smallest
}
