//! Whatever comes in, what goes out is finite, within the limits, and says what happened. Wrong if a NaN,
//! an infinity or a huge number became a torque, or if a limit acted silently.

use crate::support::{Loop, gains};
use phihat::{
    Controller, Form, GainError, JointDesign, JointGains, JointState, Limits, Measurement,
    Reference,
};

const T: f64 = 1e-3;
const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

fn limited(form: Form) -> JointGains<f64> {
    let limits = Limits::new(Some(30.0), Some(1000.0), T).unwrap();
    gains(&[4900.0, 140.0], T, form).with_limits(limits)
}

#[test]
fn nan_never_becomes_torque() {
    for form in [Form::Observer, Form::Literal] {
        let law = limited(form);
        let mut state = JointState::new();
        let good = Measurement { q: 0.01, dq: 0.1, tau_applied: 1.0 };
        for _ in 0..10 {
            law.update(&mut state, &good, &Reference::default());
        }
        let before = state;
        for bad in BAD {
            let measurements = [
                Measurement { q: bad, ..good },
                Measurement { dq: bad, ..good },
                Measurement { tau_applied: bad, ..good },
            ];
            let references = [
                Reference { q: bad, ..Reference::default() },
                Reference { dq: bad, ..Reference::default() },
                Reference { ddq: bad, ..Reference::default() },
            ];
            let all = measurements
                .iter()
                .map(|m| (*m, Reference::default()))
                .chain(references.iter().map(|r| (good, *r)));
            for (m, r) in all {
                let command = law.update(&mut state, &m, &r);
                assert!(command.status.refused);
                assert_eq!(
                    command.tau.to_bits(),
                    before.tau().to_bits(),
                    "the last torque is held"
                );
                assert_eq!(state, before, "a refused sample leaves no trace");
            }
        }
    }
}

#[test]
fn one_bad_joint_refuses_the_sample_of_the_whole_arm() {
    let arm = Controller::new([limited(Form::Observer); 3]);
    let mut states = [JointState::new(); 3];
    let mut m = [Measurement { q: 0.01, dq: 0.0, tau_applied: 0.0 }; 3];
    let r = [Reference::default(); 3];
    arm.update(&mut states, &m, &r);
    let before = states;
    m[1].dq = f64::NAN;
    let commands = arm.update(&mut states, &m, &r);
    assert!(commands.iter().all(|c| c.status.refused));
    assert_eq!(states, before);
}

/// Small, seeded generator (SplitMix64) over raw bits: every pattern can come, subnormals and NaN too.
fn bits(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *seed;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let raw = f64::from_bits(z ^ (z >> 31));
    // Half of the draws in a plausible range, so that the law also runs in between.
    if z & 1 == 0 { raw } else { ((z >> 12) as f64 / (1_u64 << 52) as f64 - 0.5) * 20.0 }
}

#[test]
fn any_bits_in_give_a_finite_torque_within_limits() {
    let mut seed = 1;
    for form in [Form::Observer, Form::Literal] {
        let law = limited(form);
        let mut state = JointState::new();
        let mut previous = 0.0_f64;
        for case in 0..200_000 {
            let m = Measurement {
                q: bits(&mut seed),
                dq: bits(&mut seed),
                tau_applied: bits(&mut seed),
            };
            let r = Reference { q: bits(&mut seed), dq: bits(&mut seed), ddq: bits(&mut seed) };
            let command = law.update(&mut state, &m, &r);
            assert!(
                command.tau.is_finite() && command.tau.abs() <= 30.0,
                "case {case}: {command:?}"
            );
            let step = (command.tau - previous).abs();
            assert!(step <= 1.0 + 1e-12, "case {case}: torque changed by {step}");
            previous = command.tau;
        }
    }
}

#[test]
fn another_laws_torque_meets_the_same_limits() {
    let limits = Limits::<f64>::new(Some(30.0), Some(1000.0), T).unwrap();
    let (mut seed, mut previous) = (2, 0.0_f64);
    for case in 0..200_000 {
        let tau = bits(&mut seed);
        let command = limits.command(tau, previous);
        let change = (command.tau - previous).abs();
        assert!(command.tau.abs() <= 30.0 && change <= 1.0 + 1e-12, "case {case}: {command:?}");
        let held = command.tau.to_bits() == previous.to_bits();
        assert!(tau.is_finite() || (held && command.status.refused), "case {case}: {command:?}");
        let inside = (tau - previous).abs() <= 1.0 && tau.abs() <= 30.0;
        assert!(!inside || command.tau.to_bits() == tau.to_bits(), "case {case}: {command:?}");
        previous = command.tau;
    }
}

#[test]
fn limits_act_and_say_so() {
    let law = limited(Form::Observer);
    let mut state = JointState::new();
    let far = Measurement { q: 1.0, dq: 0.0, tau_applied: 0.0 };
    let first = law.update(&mut state, &far, &Reference::default());
    assert!(first.status.saturated && first.status.rate_limited, "{first:?}");
    assert!(
        (first.tau + 1.0).abs() < 1e-12,
        "1000 N·m/s at 1 kHz is 1 N·m per sample: {}",
        first.tau
    );
    let quiet = law.update(
        &mut JointState::new(),
        &Measurement { q: 1e-4, dq: 0.0, tau_applied: 0.0 },
        &Reference::default(),
    );
    assert!(!quiet.status.saturated && !quiet.status.rate_limited);
}

#[test]
fn fed_with_the_applied_torque_the_observer_does_not_wind_up() {
    // A step that needs far more torque than there is: 1 rad, J = 1, limit 30 N·m.
    let overshoot = |form| {
        let limits = Limits::new(Some(30.0), None, T).unwrap();
        let mut joint = Loop::new(gains(&[4900.0, 140.0], T, form).with_limits(limits), 1.0, T);
        let reference = Reference { q: 1.0, ..Reference::default() };
        let mut most = 0.0_f64;
        for _ in 0..4000 {
            joint.step(&reference, 0.0);
            most = most.max(joint.q);
        }
        (most - 1.0, (joint.q - 1.0).abs())
    };
    let (observer, settled) = overshoot(Form::Observer);
    let (literal, _) = overshoot(Form::Literal);
    println!("overshoot: observer {observer:.3} rad, literal {literal:.3} rad");
    assert!(settled < 1e-6, "the observer form must settle: {settled}");
    assert!(observer < 0.2, "observer form: {observer}");
    assert!(literal > 0.5, "the literal form winds up: {literal}");
}

#[test]
fn bad_designs_are_refused_by_name() {
    let good = JointDesign {
        inertia: 1.0,
        kp: 400.0,
        kd: 40.0,
        a: &[70.0],
        period: T,
        form: Form::Observer,
    };
    let why = |design: &JointDesign<'_>| JointGains::<f64>::new(design).unwrap_err().to_string();
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(why(&JointDesign { inertia: value, ..good }).contains("inertia"));
        assert!(why(&JointDesign { kp: value, ..good }).contains("kp"));
        assert!(why(&JointDesign { kd: value, ..good }).contains("kd"));
        assert!(why(&JointDesign { period: value, ..good }).contains("period"));
        assert!(why(&JointDesign { a: &[70.0, value], ..good }).contains("a[1]"));
        assert!(Limits::<f64>::new(Some(value), None, T).is_err());
        assert!(Limits::<f64>::new(None, Some(value), T).is_err());
    }
    assert_eq!(
        JointGains::<f64>::new(&JointDesign { a: &[], ..good }),
        Err(GainError::Order { order: 0 })
    );
    assert!(why(&JointDesign { a: &[1.0; 5], ..good }).contains("5 coefficients"));
    // Routh straddled: s³ + 2s² + 3s + a_0 is stable for a_0 < 6 only.
    assert!(JointGains::<f64>::new(&JointDesign { a: &[5.99, 3.0, 2.0], ..good }).is_ok());
    assert!(why(&JointDesign { a: &[6.01, 3.0, 2.0], ..good }).contains("order 3"));
    // (s² + 0.2s + 1)(s² + 2s + 2) is stable; with −0.2 in place of 0.2 it is not, though all
    // coefficients of s⁴ + 1.8s³ + 2.6s² + 1.6s + 2 are positive.
    assert!(JointGains::<f64>::new(&JointDesign { a: &[2.0, 2.4, 3.4, 2.2], ..good }).is_ok());
    assert!(why(&JointDesign { a: &[2.0, 1.6, 2.6, 1.8], ..good }).contains("order 4"));
}
