//! Finite garbage: 1e305 rad/s is a number, and no velocity of an arm. Wrong if such a sample leaves a trace, so that
//! later good ones are refused or answered differently, in any part that remembers something.

use phihat::{
    Controller, Form, GainError, JointDesign, JointGains, JointOptions, JointRange, JointState,
    Limits, Measurement, ModeRequest, MotionLimits, Options, Real, Reference, Request, Sample,
    Shaper, Stamp, Supervisor, SupervisorState, Unwrap, VelocityFilter, VelocityState,
};

const T: f64 = 1e-3;

/// `(s + 70)^m`, low to high.
const A: [&[f64]; 4] = [
    &[70.0],
    &[4900.0, 140.0],
    &[343_000.0, 14_700.0, 210.0],
    &[24_010_000.0, 1_372_000.0, 29_400.0, 280.0],
];

/// Not finite, the largest, and down to just above 2³².
const GARBAGE: [f64; 10] =
    [f64::NAN, f64::INFINITY, f64::MAX, 1e305, 1e200, 1e100, 3e38, 1e30, 1e12, 4.3e9];

fn gains<R: Real>(a: &[f64], form: Form, limited: bool) -> JointGains<R> {
    let design = JointDesign { inertia: 0.8, kp: 400.0, kd: 40.0, a, period: T, form };
    let gains = JointGains::new(&design).unwrap();
    let limits = Limits::new(Some(87.0), Some(1000.0), T).unwrap();
    if limited { gains.with_limits(limits) } else { gains }
}

type Signals<R> = (Measurement<R>, Reference<R>);

/// Measurement and reference of a healthy joint.
fn good<R: Real>(k: u32) -> Signals<R> {
    let t = f64::from(k) * T;
    let n = |x: f64| R::from_f64(x);
    let m = Measurement {
        q: n(0.3 * (2.0 * t).sin()),
        dq: n(0.6 * (2.0 * t).cos()),
        tau_applied: n(3.0 + (9.0 * t).cos()),
    };
    let r = Reference {
        q: n(0.31 * (2.0 * t).sin()),
        dq: n(0.62 * (2.0 * t).cos()),
        ddq: n(-1.24 * (2.0 * t).sin()),
    };
    (m, r)
}

/// The same with one of its six values replaced.
fn spoilt<R: Real>((mut m, mut r): Signals<R>, which: usize, value: f64) -> Signals<R> {
    let places = [&mut m.q, &mut m.dq, &mut m.tau_applied, &mut r.q, &mut r.dq, &mut r.ddq];
    for (i, place) in places.into_iter().enumerate() {
        if i == which {
            *place = R::from_f64(value);
        }
    }
    (m, r)
}

/// Tells a zero from a negative one, which `==` does not.
fn bits<T: core::fmt::Debug>(value: &T) -> String {
    format!("{value:?}")
}

fn garbage_leaves_no_trace<R: Real>() -> u32 {
    let mut cases = 0;
    for form in [Form::Observer, Form::Literal] {
        for (a, limited) in A.iter().flat_map(|a| [(a, false), (a, true)]) {
            let law = gains::<R>(a, form, limited);
            for value in GARBAGE.iter().flat_map(|v| [*v, -*v]) {
                for (which, at, row) in
                    (0..6).flat_map(|w| [(w, 0, 1), (w, 1, 1), (w, 25, 1), (w, 25, 4)])
                {
                    let (mut state, mut clean) = (JointState::new(), JointState::new());
                    for k in 0..40 {
                        let (m, r) = good::<R>(k);
                        if k == at {
                            let before = bits(&state);
                            for _ in 0..row {
                                let (m, r) = spoilt((m, r), which, value);
                                let told = law.update(&mut state, &m, &r);
                                assert!(told.status.refused, "{form:?} {value:e} as {which}");
                                assert_eq!(bits(&told.tau), bits(&state.tau()));
                            }
                            assert_eq!(bits(&state), before, "{form:?} {value:e} as {which}");
                        }
                        let is = law.update(&mut state, &m, &r);
                        let want = law.update(&mut clean, &m, &r);
                        assert!(!is.status.refused, "{form:?} {value:e} as {which}: {k}");
                        assert_eq!(is, want, "{form:?} {value:e} as {which}: {k}");
                    }
                    assert_eq!(bits(&state), bits(&clean));
                    cases += 1;
                }
            }
        }
    }
    cases
}

#[test]
fn f06_finite_garbage_leaves_no_trace_in_the_law() {
    let cases = garbage_leaves_no_trace::<f64>() + garbage_leaves_no_trace::<f32>();
    println!("F6: {cases} cases of garbage, none with a trace");
    assert_eq!(cases, 2 * 2 * 4 * 2 * 20 * 24);
}

#[test]
fn f06_one_garbage_joint_refuses_the_whole_arm() {
    for value in GARBAGE {
        let arm = Controller::new([gains::<f64>(A[1], Form::Observer, true); 3]);
        let mut states = [JointState::new(); 3];
        for k in 0..10 {
            let (m, r) = good(k);
            arm.update(&mut states, &[m; 3], &[r; 3]);
        }
        let before = bits(&states);
        let (m, r) = good(10);
        for (joint, which) in (0..3).flat_map(|j| (0..6).map(move |w| (j, w))) {
            let (mut ms, mut rs) = ([m; 3], [r; 3]);
            (ms[joint], rs[joint]) = spoilt((m, r), which, value);
            let told = arm.update(&mut states, &ms, &rs);
            assert!(told.iter().all(|c| c.status.refused), "{value:e} as {which} of {joint}");
            assert_eq!(bits(&states), before, "{value:e} as {which} of {joint}");
        }
    }
}

/// A sample that is just admitted, whatever the sequence, never makes the observer refuse a good sample
/// afterwards.
fn the_largest_admitted_never_disable<R: Real>(period: f64, a: &[f64]) {
    let design = JointDesign { inertia: 50.0, kp: 1e4, kd: 200.0, a, period, form: Form::Observer };
    let law = JointGains::<R>::new(&design).unwrap();
    let mut state = JointState::new();
    let most = 4.29e9;
    let mut seed = 5_u64;
    for k in 0..20_000 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // All corners of the box, the alternating ones among them.
        let sign = |bit: u32| {
            let up =
                if k % 2000 < 1000 { (seed >> (40 + bit)) & 1 } else { u64::from(k + bit) & 1 };
            R::from_f64(if up == 1 { most } else { -most })
        };
        let m = Measurement { q: sign(0), dq: sign(1), tau_applied: sign(2) };
        let r = Reference { q: sign(3), dq: sign(4), ddq: sign(5) };
        let told = law.update(&mut state, &m, &r);
        assert!(!told.status.refused && told.tau.is_finite(), "order {} at {k}", a.len());
    }
    for k in 0..100 {
        let (m, r) = good::<R>(k);
        assert!(!law.update(&mut state, &m, &r).status.refused, "order {} after {k}", a.len());
    }
}

#[test]
fn f06_the_largest_admitted_samples_never_disable_the_observer() {
    for a in A {
        the_largest_admitted_never_disable::<f32>(T, a);
        the_largest_admitted_never_disable::<f64>(T, a);
    }
    // The fastest estimator that a sampled loop can have: all poles at the origin.
    let fast: &[f64] = &[1.0e18, 1.2e14, 6e9, 1.3e5];
    the_largest_admitted_never_disable::<f32>(1e-3, fast);
}

#[test]
fn f06_a_torque_that_is_none_is_not_resumed_from() {
    for form in [Form::Observer, Form::Literal] {
        for a in A {
            let law = gains::<f64>(a, form, false);
            let (m, r) = good(3);
            let mut state = JointState::new();
            law.update(&mut state, &m, &r);
            let before = bits(&state);
            for value in GARBAGE.iter().flat_map(|v| [*v, -*v]) {
                assert!(!law.resume(&mut state, &m, &r, value), "{value:e}");
                for which in 0..6 {
                    let (m, r) = spoilt((m, r), which, value);
                    assert!(!law.resume(&mut state, &m, &r, 1.0), "{value:e} as {which}");
                }
                assert_eq!(bits(&state), before, "{value:e}");
            }
            assert!(law.resume(&mut state, &m, &r, 1.0));
        }
    }
}

#[test]
fn f06_a_torque_resumed_from_never_holds_the_arm_beyond_its_limit() {
    for (form, a) in [Form::Observer, Form::Literal].into_iter().flat_map(|f| A.map(|a| (f, a))) {
        let law = gains::<f64>(a, form, true);
        for tau in [86.9, 87.1, 400.0, 1e9].into_iter().flat_map(|tau| [tau, -tau]) {
            let (m, r) = good(3);
            let mut state = JointState::new();
            assert!(law.resume(&mut state, &m, &r, tau));
            let (spoilt, _) = spoilt((m, r), 0, f64::NAN);
            let held = law.update(&mut state, &spoilt, &r);
            assert!(held.status.refused, "{tau}");
            assert_eq!(bits(&held.tau), bits(&tau.clamp(-87.0, 87.0)));
            assert!(law.update(&mut state, &m, &r).tau.abs() <= 87.0, "{tau}");
        }
    }
}

#[test]
fn f06_garbage_positions_leave_no_trace_in_the_velocity_filter() {
    for bandwidth in [None, Some(100.0)] {
        let filter = VelocityFilter::<f64>::new(bandwidth, T).unwrap();
        for (value, at) in GARBAGE.iter().flat_map(|v| [(*v, 0), (-*v, 1), (*v, 25)]) {
            let (mut state, mut clean) = (VelocityState::default(), VelocityState::default());
            let (mut last, mut before) = (0.0, 0.0);
            for k in 0..60 {
                if k == at {
                    let untouched = bits(&state);
                    before = filter.estimate(&mut state, value, T);
                    assert_eq!(bits(&before), bits(&last), "{value:e}: the last velocity");
                    assert_eq!(bits(&state), untouched, "{value:e} at {at}");
                }
                let q = (7.0 * f64::from(k) * T).sin();
                last = filter.estimate(&mut state, q, T);
                assert_eq!(bits(&last), bits(&filter.estimate(&mut clean, q, T)), "{value:e}");
            }
            assert!(before.is_finite());
        }
        // An interval that is none: the difference overflows, and is not remembered.
        let mut state = VelocityState::default();
        filter.estimate(&mut state, 0.0, T);
        let before = bits(&state);
        for interval in [1e-310, f64::NAN, -1.0, 0.0] {
            assert!(filter.estimate(&mut state, 0.1, interval).is_finite(), "{interval:e}");
            assert!(!bits(&state).contains("inf"), "{before} became {state:?}");
        }
        let later = filter.estimate(&mut state, 0.2, T);
        assert!(later.is_finite() && later.abs() <= 200.0, "{later}");
    }
}

#[test]
fn f08_garbage_readings_do_not_turn_a_joint() {
    // A joint at 3 rad, forward through π, with garbage in between, signs in every order.
    for value in GARBAGE.iter().chain(&[100.0, 13.0]) {
        for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            for before_first in [false, true] {
                let mut angle = Unwrap::<f64>::new();
                if before_first {
                    let told = angle.take(signs[0] * value);
                    assert_eq!(bits(&told), bits(&(signs[0] * value)), "as it is");
                }
                assert!((angle.take(3.0) - 3.0).abs() < 1e-12, "{value:e}");
                for sign in signs {
                    assert_eq!(bits(&angle.take(sign * value)), bits(&(sign * value)), "as it is");
                }
                assert!((angle.take(3.1) - 3.1).abs() < 1e-12, "{value:e} {signs:?}");
                angle.take(signs[1] * value);
                let through = angle.take(-3.1);
                assert!((through - (core::f64::consts::TAU - 3.1)).abs() < 1e-12, "{through}");
            }
        }
    }
}

#[test]
fn f21_a_garbage_target_asks_the_governor_for_a_stop() {
    let limits = MotionLimits { velocity: 1.0, acceleration: 5.0, jerk: 50.0 };
    let shaper = Shaper::<f64>::new(&limits, T).unwrap();
    for value in GARBAGE.iter().flat_map(|v| [*v, -*v]) {
        for which in 3..6 {
            let mut now = Reference::default();
            let far = Reference { q: 3.0, ..Reference::default() };
            for _ in 0..500 {
                now = shaper.step(&now, &far);
            }
            assert!(now.dq > 0.5);
            let from = now.q;
            let (_, target) = spoilt((Measurement::default(), far), which, value);
            for _ in 0..3000 {
                let next = shaper.step(&now, &target);
                let use_of = [
                    next.dq / limits.velocity,
                    next.ddq / limits.acceleration,
                    (next.ddq - now.ddq) / (limits.jerk * T),
                ];
                assert!(use_of.iter().all(|u| u.abs() <= 1.0 + 1e-9), "{value:e}: {next:?}");
                now = next;
            }
            assert!(now.dq.abs() < 1e-9 && (now.q - from).abs() < 1.0, "{value:e}: {now:?}");
            // And the next good target is followed.
            for _ in 0..8000 {
                now = shaper.step(&now, &far);
            }
            assert!((now.q - 3.0).abs() < 1e-6, "{value:e}: {now:?}");
        }
    }
}

#[test]
fn gains_that_could_overflow_are_refused() {
    fn tried<R: Real>(design: JointDesign<'_>) -> Vec<Result<(), GainError>> {
        [Form::Observer, Form::Literal]
            .map(|form| JointGains::<R>::new(&JointDesign { form, ..design }).map(|_| ()))
            .to_vec()
    }
    let good =
        JointDesign { inertia: 0.8, kp: 400.0, kd: 40.0, a: A[3], period: T, form: Form::Observer };
    assert_eq!(tried::<f32>(good), [Ok(()); 2]);
    let (large, small) = ([Err(GainError::Overflow); 2], [Ok(()); 2]);
    for value in [1e20, 1e30, 1e-45] {
        let inertia = JointDesign { inertia: value, ..good };
        assert_eq!((tried::<f32>(inertia), tried::<f64>(inertia)), (large.into(), small.into()));
    }
    // Each of the others alone: what is finite in f64 need not be in f32.
    for design in [
        JointDesign { kp: 1e20, ..good },
        JointDesign { kd: 1e20, ..good },
        JointDesign { period: 1e-40, ..good },
        JointDesign { a: &[1e20], period: 1e-30, ..good },
    ] {
        assert_eq!((tried::<f32>(design), tried::<f64>(design)), (large.into(), small.into()));
    }
    assert_eq!(tried::<f64>(JointDesign { inertia: 1e300, ..good }), large);
    assert_eq!(tried::<f64>(JointDesign { inertia: 1e-310, ..good }), large);
    let far = JointDesign { a: &[1e300, 1e200], ..good };
    assert_eq!(tried::<f64>(far), large, "coefficients that overflow on the way");
}

/// One arm under supervision; at sample 40 one of the values is `value`. Everything it answered, and its state.
fn supervised<R: Real>(joint: &JointOptions<R>, which: usize, value: f64) -> Vec<String> {
    let gains = gains::<R>(A[1], Form::Observer, true);
    let arm = Supervisor::new([gains; 2], &[*joint; 2], &Options::new(1_000_000)).unwrap();
    let mut state = SupervisorState::new();
    let mut told = Vec::new();
    for k in 0..100 {
        let (mut m, mut r) = good::<R>(k);
        (m.q, r.q, m.dq) = (R::from_f64(1e-4 * f64::from(k)), R::ZERO, R::from_f64(0.01));
        (r.dq, r.ddq) = (R::ZERO, R::ZERO);
        let (mut joints, mut references) = ([m; 2], [r; 2]);
        if k == 40 {
            (joints[1], references[1]) = spoilt((m, r), which, value);
        }
        let t_ns = 1_000_000 * u64::from(k);
        let stamp = Stamp { sequence: u64::from(k), t_ns };
        let mode = match k {
            0..10 => ModeRequest::Arm,
            10..20 => ModeRequest::Hold,
            _ => ModeRequest::Track,
        };
        let sample = Sample { stamp, now_ns: t_ns, joints: &joints };
        let preset = [R::from_f64(1.0), R::from_f64(if which == 6 { value } else { 2.0 })];
        let request =
            Request { mode, references: &references, preset: Some(&preset), feed_forward: None };
        let answer = arm.step(&mut state, &sample, &request);
        assert_eq!(answer.report.fault, None, "{value:e} as {which}: {:?}", answer.report);
        assert!(answer.commands.iter().all(|c| c.tau.is_finite()));
        if (39..45).contains(&k) || k == 99 {
            told.push(bits(&(answer, state)));
        }
    }
    told
}

fn garbage_is_like_nan<R: Real>(joint: &JointOptions<R>) {
    for which in 0..7 {
        let nan = supervised::<R>(joint, which, f64::NAN);
        for value in GARBAGE.iter().flat_map(|v| [*v, -*v]) {
            let is = supervised::<R>(joint, which, value);
            let differs = is.iter().zip(&nan).position(|(is, nan)| is != nan);
            assert_eq!(differs, None, "{value:e} as {which}");
        }
    }
}

#[test]
fn f06_to_the_supervisor_finite_garbage_is_what_nan_is() {
    garbage_is_like_nan::<f64>(&JointOptions::default());
    garbage_is_like_nan::<f32>(&JointOptions::default());
    let full = JointOptions {
        velocity_max: Some(3.0),
        range: Some(JointRange { lower: -1.0, upper: 1.0, soft: 0.1, braking: 5.0 }),
        error_stop: Some(0.1),
        frozen_travel: Some(1.0),
        motion: Some(MotionLimits { velocity: 1.0, acceleration: 5.0, jerk: 50.0 }),
        oscillation: Some(3.0),
        first_motion: Some(50.0),
        ..JointOptions::default()
    };
    garbage_is_like_nan::<f64>(&full);
}

#[test]
fn what_would_overflow_in_the_law_is_refused_and_not_stored() {
    // Integrals of a large error over long periods, weighed with large gains, leave all bounds.
    let design = JointDesign {
        inertia: 0.8,
        kp: 1e270,
        kd: 40.0,
        a: A[3],
        period: 1e3,
        form: Form::Literal,
    };
    let law = JointGains::<f64>::new(&design).unwrap();
    let mut state = JointState::new();
    let m = Measurement { q: 4e9, ..Measurement::default() };
    let mut refused = 0;
    for _ in 0..10_000 {
        let before = state;
        let told = law.update(&mut state, &m, &Reference::default());
        assert!(told.tau.is_finite() && told.phi_hat.is_finite());
        if told.status.refused {
            assert_eq!(bits(&state), bits(&before));
            refused += 1;
        }
    }
    assert!(refused > 5000, "this test can fail: {refused}");
}
