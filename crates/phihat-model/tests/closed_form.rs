//! Pendulum, two-link arm, slider and cart with pendulum against the formulas of textbooks.

use crate::support::{Random, inertial, joint, link, mass_matrix, model_of, relative_error};
use phihat_model::Workspace;

const G: f64 = 9.81;

#[test]
fn pendulum_swings_as_its_formula_says() {
    // About y from straight up: τ = (I + m l²) q̈ − m g l sin q.
    let (m, l, i) = (2.5, 0.7, 0.04);
    let model = model_of(&[
        link("base", ""),
        link("bob", &inertial(m, [0.0, 0.0, l], [i, 0.0, 0.0, i, 0.0, 0.01])),
        joint("pivot", "revolute", ["base", "bob"], "0 0 1", "0 1 0"),
    ]);
    let mut ws = Workspace::new(&model);
    for q in [-2.0, 0.0, 0.3, 1.5] {
        let mut tau = [0.0];
        model.inverse_dynamics(&mut ws, &[q], &[5.0], &[0.8], &mut tau);
        let expected = (i + m * l * l) * 0.8 - m * G * l * f64::sin(q);
        assert!((tau[0] - expected).abs() < 1e-13);
    }
}

#[test]
fn two_link_arm_obeys_its_textbook_equations() {
    // Spong, Hutchinson, Vidyasagar, Robot Modeling and Control, section 7.4, in the x-y plane.
    let (m1, m2, l1, c1, c2, i1, i2) = (3.0, 2.0, 0.5, 0.2, 0.3, 0.05, 0.03);
    let body = |m, c, i| inertial(m, [c, 0.0, 0.0], [i, 0.0, 0.0, i, 0.0, i]);
    let model = model_of(&[
        link("base", ""),
        link("upper", &body(m1, c1, i1)),
        link("lower", &body(m2, c2, i2)),
        joint("shoulder", "revolute", ["base", "upper"], "0 0 0", "0 0 1"),
        joint("elbow", "revolute", ["upper", "lower"], &format!("{l1} 0 0"), "0 0 1"),
    ])
    .with_gravity([0.0, -G, 0.0]);
    let (mut ws, mut random) = (Workspace::new(&model), Random(10));
    for _ in 0..100 {
        let (q, dq) = (random.vector(2, 3.0), random.vector(2, 3.0));
        let d12 = m2 * (c2 * c2 + l1 * c2 * q[1].cos()) + i2;
        let d22 = m2 * c2 * c2 + i2;
        let d11 = m1 * c1 * c1 + i1 + i2 + m2 * (l1 * l1 + c2 * c2 + 2.0 * l1 * c2 * q[1].cos());
        let h = -m2 * l1 * c2 * q[1].sin();
        let g2 = m2 * c2 * G * (q[0] + q[1]).cos();
        let g1 = (m1 * c1 + m2 * l1) * G * q[0].cos() + g2;
        let expected = [h * (2.0 * dq[0] * dq[1] + dq[1] * dq[1]) + g1, -h * dq[0] * dq[0] + g2];
        assert!(relative_error(&mass_matrix(&model, &mut ws, &q), &[d11, d12, d12, d22]) < 1e-13);
        let mut bias = [0.0; 2];
        model.bias(&mut ws, &q, &dq, &mut bias);
        assert!(relative_error(&bias, &expected) < 1e-13);
    }
}

#[test]
fn a_slider_carries_its_weight() {
    let model = model_of(&[
        link("base", ""),
        link("load", &inertial(4.0, [0.1, 0.2, 0.3], [0.1, 0.0, 0.0, 0.1, 0.0, 0.1])),
        joint("lift", "prismatic", ["base", "load"], "0 1 0", "0 0 2"),
    ]);
    let (mut ws, mut force) = (Workspace::new(&model), [0.0]);
    model.inverse_dynamics(&mut ws, &[0.4], &[1.0], &[2.0], &mut force);
    assert!((force[0] - 4.0 * (G + 2.0)).abs() < 1e-12);
    model.forward_kinematics(&mut ws, &[0.4]);
    let p = model.pose(&ws, model.frame("load").unwrap()).p;
    assert!(relative_error(&p, &[0.0, 1.0, 0.4]) < 1e-15);
}

#[test]
fn a_pendulum_on_a_cart_obeys_its_textbook_equations() {
    // Cart M along x, bob m hanging at length l: q = (x, angle from straight down about −y… +x).
    let (cart, m, l) = (3.0, 0.8, 0.6);
    let tiny = [1e-12, 0.0, 0.0, 1e-12, 0.0, 1e-12];
    let model = model_of(&[
        link("base", ""),
        link("cart", &inertial(cart, [0.0; 3], tiny)),
        link("bob", &inertial(m, [0.0, 0.0, -l], tiny)),
        joint("rail", "prismatic", ["base", "cart"], "0 0 0", "1 0 0"),
        joint("pivot", "revolute", ["cart", "bob"], "0 0 0", "0 -1 0"),
    ]);
    let (mut ws, mut random) = (Workspace::new(&model), Random(11));
    for _ in 0..50 {
        let (q, dq) = (random.vector(2, 3.0), random.vector(2, 3.0));
        let (s, c) = q[1].sin_cos();
        let expected = [cart + m, m * l * c, m * l * c, m * l * l];
        assert!(relative_error(&mass_matrix(&model, &mut ws, &q), &expected) < 1e-11);
        let mut bias = [0.0; 2];
        model.bias(&mut ws, &q, &dq, &mut bias);
        assert!(relative_error(&bias, &[-m * l * s * dq[1] * dq[1], m * G * l * s]) < 1e-11);
    }
}
