//! Changing gains, inertia or order while a load is held does not jump the torque. Wrong if `resume` did
//! not put the difference into φ̂; the naive change must jump.
#![allow(clippy::large_types_passed_by_value, reason = "tests: a panic is the report")]

use crate::support::Loop;
use phihat::{Form, JointDesign, JointGains, JointState, Limits, Measurement, Reference};

const T: f64 = 1e-3;
const LOAD: f64 = 40.0;

fn law(inertia: f64, kp: f64, a: &[f64], form: Form) -> JointGains<f64> {
    let design = JointDesign { inertia, kp, kd: 2.0 * kp.sqrt(), a, period: T, form };
    JointGains::new(&design).unwrap()
}

/// Largest torque change per sample in the half second around a change of gains under load.
fn jump(from: JointGains<f64>, to: JointGains<f64>, resume: bool) -> f64 {
    let mut joint = Loop::new(from, 1.1, T);
    let reference = |t: f64| Reference { q: 0.1 * t, dq: 0.1, ddq: 0.0 };
    let mut last = 0.0;
    while joint.k < 4000 {
        last = joint.step(&reference(joint.time()), LOAD).tau;
    }
    let before = (joint.measurement(), reference(joint.time()));
    let tau = joint.step(&before.1, LOAD).tau; // sample 4000 under the old gains
    assert!((tau - last).abs() < 1e-6, "must have settled: {}", tau - last);
    joint.gains = to;
    if resume {
        assert!(joint.gains.resume(&mut joint.state, &before.0, &before.1, tau));
    }
    let mut largest = 0.0_f64;
    let mut previous = tau;
    for _ in 0..500 {
        let now = joint.step(&reference(joint.time()), LOAD).tau;
        largest = largest.max((now - previous).abs());
        previous = now;
    }
    if resume {
        assert!((previous - LOAD).abs() < 1e-3, "the load must still be held, not {previous}");
    }
    largest
}

#[test]
fn no_torque_jump_on_any_change() {
    let low: &[f64] = &[70.0];
    let mid: &[f64] = &[4900.0, 140.0];
    let high: &[f64] = &[64_000.0, 4800.0, 120.0];
    for form in [Form::Observer, Form::Literal] {
        let changes = [
            ("raise order", law(1.0, 400.0, low, form), law(1.0, 400.0, mid, form)),
            ("raise order twice", law(1.0, 400.0, low, form), law(1.0, 400.0, high, form)),
            ("lower order", law(1.0, 400.0, high, form), law(1.0, 400.0, low, form)),
            ("lower order by one", law(1.0, 400.0, high, form), law(1.0, 400.0, mid, form)),
            ("stiffer", law(1.0, 400.0, mid, form), law(1.0, 900.0, mid, form)),
            ("softer, first order", law(1.0, 400.0, low, form), law(1.0, 100.0, low, form)),
            ("other inertia", law(1.0, 400.0, mid, form), law(1.6, 400.0, mid, form)),
        ];
        for (name, from, to) in changes {
            let bump = jump(from, to, true);
            println!("{form:?} {name}: {bump:.2e} N·m");
            assert!(bump < 1e-6, "{form:?} {name}: {bump:e} N·m");
        }
    }
}

#[test]
fn the_naive_change_jumps() {
    let bump = jump(
        law(1.0, 400.0, &[70.0], Form::Literal),
        law(1.0, 400.0, &[4900.0, 140.0], Form::Literal),
        false,
    );
    assert!(bump > 10.0, "raising the order of the literal form without `resume`: {bump} N·m");
}

#[test]
fn starting_from_a_held_load_is_seamless() {
    for form in [Form::Observer, Form::Literal] {
        for a in [&[70.0][..], &[4900.0, 140.0], &[64_000.0, 4800.0, 120.0]] {
            let gains = law(1.0, 400.0, a, form);
            let mut state = JointState::new();
            let m = Measurement { q: 0.3, dq: 0.0, tau_applied: LOAD };
            let r = Reference { q: 0.3, dq: 0.0, ddq: 0.0 };
            assert!(gains.resume(&mut state, &m, &r, LOAD));
            let next = gains.update(&mut state, &m, &r);
            assert!((next.tau - LOAD).abs() < 1e-9, "{form:?} {a:?}: {}", next.tau);
        }
    }
}

#[test]
fn resume_refuses_what_is_not_finite_and_changes_nothing() {
    let gains = law(1.0, 400.0, &[70.0], Form::Observer).with_limits(Limits::none());
    let mut state = JointState::new();
    let before = state;
    let m = Measurement { q: f64::NAN, ..Measurement::default() };
    assert!(!gains.resume(&mut state, &m, &Reference::default(), 1.0));
    assert!(!gains.resume(
        &mut state,
        &Measurement::default(),
        &Reference::default(),
        f64::INFINITY
    ));
    assert_eq!(state, before);
}
