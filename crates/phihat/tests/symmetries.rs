//! Mirror the robot and the torque mirrors, bit for bit; permute the joints and the torques permute.
//! Wrong if a sign, an index or a state were shared between joints.

use phihat::{
    Command, Controller, Form, JointDesign, JointGains, JointState, Limits, Measurement, Reference,
};

const T: f64 = 1e-3;

fn joint(i: usize) -> JointGains<f64> {
    let all: [&[f64]; 4] = [
        &[60.0],
        &[4900.0, 140.0],
        &[64_000.0, 4800.0, 120.0],
        &[810_000.0, 108_000.0, 5400.0, 120.0],
    ];
    let form = if i.is_multiple_of(2) { Form::Observer } else { Form::Literal };
    let bump = i as f64;
    let design =
        JointDesign { inertia: 0.3 + bump, kp: 300.0 + bump, kd: 35.0, a: all[i], period: T, form };
    let limits = Limits::new(Some(9.0 + bump), Some(4000.0), T).unwrap();
    JointGains::new(&design).unwrap().with_limits(limits)
}

fn sample(k: u32, i: usize, sign: f64) -> (Measurement<f64>, Reference<f64>) {
    let x = f64::from(k) * 0.013 + i as f64;
    let m = Measurement {
        q: sign * 0.02 * x.sin(),
        dq: sign * 0.3 * (1.7 * x).cos(),
        tau_applied: sign * 3.0 * (0.9 * x).sin(),
    };
    let r = Reference {
        q: sign * 0.01 * (0.5 * x).cos(),
        dq: sign * 0.1 * x.sin(),
        ddq: sign * x.cos(),
    };
    (m, r)
}

fn run(order: [usize; 4], sign: f64) -> Vec<[Command<f64>; 4]> {
    let controller = Controller::new(order.map(joint));
    let mut states = [JointState::new(); 4];
    (0..800)
        .map(|k| {
            let samples = order.map(|i| sample(k, i, sign));
            controller.update(&mut states, &samples.map(|s| s.0), &samples.map(|s| s.1))
        })
        .collect()
}

#[test]
fn mirrored_robot_gets_mirrored_torque() {
    let plain = run([0, 1, 2, 3], 1.0);
    let mirrored = run([0, 1, 2, 3], -1.0);
    assert!(plain.iter().flatten().any(|c| c.status.saturated), "limits must take part");
    for (a, b) in plain.iter().flatten().zip(mirrored.iter().flatten()) {
        assert_eq!(a.tau.to_bits(), (-b.tau).to_bits());
        assert_eq!(a.phi_hat.abs().to_bits(), b.phi_hat.abs().to_bits());
        assert_eq!(a.status, b.status);
    }
}

#[test]
fn permuted_joints_get_permuted_torques() {
    let order = [2, 0, 3, 1];
    let plain = run([0, 1, 2, 3], 1.0);
    let permuted = run(order, 1.0);
    for (a, b) in plain.iter().zip(&permuted) {
        for (slot, joint) in order.into_iter().enumerate() {
            assert_eq!(a[joint], b[slot]);
        }
    }
}

#[test]
fn single_precision_follows_double() {
    let a = [4900.0, 140.0];
    let design =
        JointDesign { inertia: 0.8, kp: 400.0, kd: 40.0, a: &a, period: T, form: Form::Observer };
    let wide = JointGains::<f64>::new(&design).unwrap();
    let narrow = JointGains::<f32>::new(&design).unwrap();
    let (mut state, mut state_narrow) = (JointState::new(), JointState::new());
    let mut largest = 0.0_f64;
    let mut scale = 0.0_f64;
    for k in 0..5000 {
        let (m, r) = sample(k, 1, 1.0);
        #[allow(clippy::cast_possible_truncation, reason = "the test is about rounding to f32")]
        let f = |x: f64| x as f32;
        let m32 = Measurement { q: f(m.q), dq: f(m.dq), tau_applied: f(m.tau_applied) };
        let r32 = Reference { q: f(r.q), dq: f(r.dq), ddq: f(r.ddq) };
        let tau = wide.update(&mut state, &m, &r).tau;
        let tau_narrow = narrow.update(&mut state_narrow, &m32, &r32).tau;
        largest = largest.max((tau - f64::from(tau_narrow)).abs());
        scale = scale.max(tau.abs());
    }
    println!("f32 against f64: {largest:.2e} of {scale:.2} N·m");
    assert!(largest < 2e-5 * scale, "{largest} of {scale}");
}
