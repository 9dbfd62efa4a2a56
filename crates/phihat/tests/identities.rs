//! Multiplied out, the law is controllers that people know. Wrong if any gain were weighted wrongly.

use crate::support::{KD, KP, Loop, gains};
use phihat::{Form, JointDesign, JointGains, JointState, Measurement, Reference};

const T: f64 = 1e-3;

/// A lively, deterministic signal; no two entries alike.
fn signal(k: u32, seed: f64) -> f64 {
    let t = f64::from(k) * T;
    0.01 * (17.0 * t + seed).sin() + 0.004 * (53.0 * t + 2.0 * seed).cos()
}

fn sample(k: u32) -> (Measurement<f64>, Reference<f64>) {
    let m = Measurement { q: signal(k, 0.3), dq: 10.0 * signal(k, 1.1), tau_applied: 0.0 };
    let r = Reference { q: signal(k, 2.0), dq: 10.0 * signal(k, 2.9), ddq: 90.0 * signal(k, 4.0) };
    (m, r)
}

#[test]
fn first_order_is_a_pid_with_acceleration_feed_forward() {
    let (a0, inertia) = (68.9, 0.7);
    let design = JointDesign { inertia, kp: KP, kd: KD, a: &[a0], period: T, form: Form::Literal };
    let law = JointGains::<f64>::new(&design).unwrap();
    let mut state = JointState::new();
    let mut integral = 0.0;
    for k in 0..2000 {
        let (m, r) = sample(k);
        let (e, de) = (m.q - r.q, m.dq - r.dq);
        integral += if k == 0 { 0.0 } else { T * e };
        // p = M̄(K_p + a_0 K_d), i = M̄ a_0 K_p, d = M̄(K_d + a_0).
        let pid = inertia * r.ddq
            - inertia * (KD + a0) * de
            - inertia * (KP + a0 * KD) * e
            - inertia * a0 * KP * integral;
        let tau = law.update(&mut state, &m, &r).tau;
        assert!((tau - pid).abs() < 1e-11 * (1.0 + pid.abs()), "sample {k}: {tau} against {pid}");
    }
}

#[test]
fn second_order_is_a_pi2d() {
    let (a0, a1) = (4844.0, 139.2);
    let law = gains(&[a0, a1], T, Form::Literal);
    let mut state = JointState::new();
    let (mut integral, mut double) = (0.0, 0.0);
    for k in 0..2000 {
        let (m, r) = sample(k);
        let (e, de) = (m.q - r.q, m.dq - r.dq);
        if k > 0 {
            integral += T * e;
            double += T * integral;
        }
        let expected = r.ddq
            - (KD + a1) * de
            - (KP + a1 * KD + a0) * e
            - (a1 * KP + a0 * KD) * integral
            - a0 * KP * double;
        let tau = law.update(&mut state, &m, &r).tau;
        assert!((tau - expected).abs() < 1e-10 * (1.0 + expected.abs()), "sample {k}");
    }
}

#[test]
fn first_order_is_the_hinf_pid_of_choi_with_feed_forward() {
    // τ = q̈_d − k_c (ė + K_P e + K_I ∫e), k_c = K + 1/γ² = K_d + a_0.
    let a0 = 68.9;
    let law = gains(&[a0], T, Form::Literal);
    let mut state = JointState::new();
    let k_c = KD + a0;
    let (k_p, k_i) = ((KP + a0 * KD) / k_c, a0 * KP / k_c);
    let mut integral = 0.0;
    for k in 0..500 {
        let (m, r) = sample(k);
        let e = m.q - r.q;
        integral += if k == 0 { 0.0 } else { T * e };
        let expected = r.ddq - k_c * ((m.dq - r.dq) + k_p * e + k_i * integral);
        let tau = law.update(&mut state, &m, &r).tau;
        assert!((tau - expected).abs() < 1e-11 * (1.0 + expected.abs()), "sample {k}");
    }
}

#[test]
fn first_order_is_a_disturbance_observer() {
    // φ̂ = low-pass of (τ_applied − M̄ q̈) with cut-off a_0, sampled exactly:
    // φ̂_k = p φ̂_{k−1} + (1 − p)(τ_{k−1} − M̄ (q̇_k − q̇_{k−1})/T), p = e^{−a_0 T}.
    let a0: f64 = 55.0;
    let pole = (-a0 * T).exp();
    let mut joint = Loop::new(gains(&[a0], T, Form::Observer), 1.7, T);
    let mut expected = 0.0;
    let mut before = (joint.dq, 0.0);
    for k in 0..1500 {
        if k > 0 {
            let phi = before.1 - (joint.dq - before.0) / T;
            expected = pole * expected + (1.0 - pole) * phi;
        }
        let dq = joint.dq;
        let command =
            joint.step(&Reference { q: 0.1, ..Reference::default() }, 4.0 + signal(k, 0.0));
        before = (dq, command.tau);
        assert!((command.phi_hat - expected).abs() < 1e-9 * (1.0 + expected.abs()), "sample {k}");
    }
}

#[test]
fn a_very_fast_first_order_is_time_delay_control() {
    // a_0 T ≫ 1: φ̂_k = τ_{k−1} − M̄ (q̇_k − q̇_{k−1})/T, the estimate of time-delay control.
    let mut joint = Loop::new(gains(&[1e5], T, Form::Observer), 1.2, T);
    let mut before: Option<(f64, f64)> = None;
    for k in 0..200 {
        let dq = joint.dq;
        let command = joint.step(&Reference { q: 0.05, ..Reference::default() }, 3.0);
        if let Some((dq_before, tau_before)) = before {
            let expected = tau_before - (dq - dq_before) / T;
            assert!((command.phi_hat - expected).abs() < 1e-8, "sample {k}");
        }
        before = Some((dq, command.tau));
    }
}
