//! The parts at the boundary. Wrong if a torque could reach another joint, if a record lost count, if an integral
//! drifted, or if a scalar guard let a bad pattern through.

use crate::arm::Dice;
use phihat::{
    Command, DELAY_MAX, Delay, Form, JointDesign, JointGains, JointMap, JointMapError, JointState,
    Limits, Log, Measurement, Real, Reference, VelocityFilter, VelocityState, order_hash,
    update_joints,
};

const NAMES: [&str; 7] = ["base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3", "flange"];

/// All orders of seven joints (Heap's algorithm).
fn permutations(visit: &mut impl FnMut(&[usize; 7])) {
    fn go(k: usize, order: &mut [usize; 7], visit: &mut impl FnMut(&[usize; 7])) {
        if k == 1 {
            return visit(order);
        }
        for i in 0..k {
            go(k - 1, order, visit);
            order.swap(if k.is_multiple_of(2) { i } else { 0 }, k - 1);
        }
    }
    go(7, &mut [0, 1, 2, 3, 4, 5, 6], visit);
}

#[test]
fn f07_all_orders_of_seven_joints_are_mapped() {
    let (mut count, mut hashes) = (0, std::collections::BTreeSet::new());
    permutations(&mut |order| {
        let names = order.map(|i| NAMES[i]);
        let map = JointMap::new(&NAMES, &names).unwrap();
        let message = order.map(|i| i as f64);
        let own = map.gather(&message).unwrap();
        let bits = |values: [f64; 7]| values.map(f64::to_bits);
        assert_eq!(bits(own), bits([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), "{order:?}");
        let mut back = [f64::NAN; 7];
        assert!(map.scatter(&own, &mut back));
        assert_eq!(bits(back), bits(message));
        hashes.insert(order_hash(&names));
        count += 1;
    });
    assert_eq!((count, hashes.len()), (5040, 5040), "every order has its own fingerprint");
}

#[test]
fn f07_names_that_do_not_fit_are_refused() {
    let mut other = NAMES;
    other[3] = "wrist";
    assert_eq!(JointMap::new(&NAMES, &other), Err(JointMapError::Missing { joint: 3 }));
    other[3] = "elbow";
    assert!(JointMap::new(&NAMES, &other).is_err());
    let twice = ["base", "base"];
    assert_eq!(JointMap::new(&twice, &NAMES), Err(JointMapError::Twice { joint: 0 }));
    // A gripper between the arm's joints is left alone.
    let map = JointMap::new(&["a", "b"], &["b", "gripper", "a"]).unwrap();
    let mut message = [2.0_f64, 9.0, 1.0];
    assert_eq!(map.gather(&message), Some([1.0, 2.0]));
    assert!(map.scatter(&[-1.0, -2.0], &mut message));
    assert!((message[1] - 9.0).abs() < 1e-12);
    assert!(map.gather(&[0.0; 2]).is_none() && !map.scatter(&[0.0; 2], &mut [0.0; 2]));
    // The border between two names counts.
    assert_ne!(order_hash(&["ab", "c"]), order_hash(&["a", "bc"]));
}

#[test]
fn f27_a_stalled_reader_loses_entries_and_not_their_count() {
    let mut log = Log::<u64, 64>::new();
    // 60 s at 1 kHz without a reader.
    let kept = (0..60_000).filter(|k| log.push(*k)).count();
    assert_eq!((kept, log.len(), log.dropped()), (64, 64, 60_000 - 64));
    // Then it reads faster and slower than the ticks come; order and counts are those of a queue.
    let mut model: std::collections::VecDeque<u64> = (0..64).collect();
    let (mut dice, mut dropped) = (Dice(27), 60_000 - 64);
    for k in 0..200_000 {
        if dice.bits().is_multiple_of(2) {
            if model.len() < 64 {
                model.push_back(k);
            } else {
                dropped += 1;
            }
            log.push(k);
        } else {
            assert_eq!(log.pop(), model.pop_front());
        }
    }
    assert_eq!((log.len(), log.dropped()), (model.len(), dropped));
}

/// Relative error of `∫e` after so many samples: read from the torque of the literal form, against an exact sum.
fn drift(samples: u32) -> f64 {
    let period = 1e-3;
    let design =
        JointDesign { inertia: 1.0, kp: 1.0, kd: 1.0, a: &[1.0], period, form: Form::Literal };
    let law = JointGains::<f64>::new(&design).unwrap();
    let mut state = JointState::new();
    // The error alternates between two binary fractions: their sum is exact in integers.
    let (even, odd) = (3.0 * 2.0_f64.powi(-20), -(2.0_f64.powi(-21)));
    let command = |q| Measurement { q, dq: 0.0, tau_applied: 0.0 };
    let mut last = 0.0;
    for k in 0..samples {
        let e = if k.is_multiple_of(2) { even } else { odd };
        last = law.update(&mut state, &command(e), &Reference::default()).phi_hat;
    }
    // φ̂ = −(on_e e + on_∫ ∫e): K_p, K_d, a_0 are 1, so on_∫ = 1 and on_e = 1 + K_d a_0 − … = a_0 K_d = 1.
    let e = if samples.is_multiple_of(2) { odd } else { even };
    let integral = -(last + e);
    // The first sample starts the law; from the second on each adds T e.
    let (odds, evens) = (samples / 2, (samples - 1) / 2);
    let exact = period * (f64::from(odds) * odd + f64::from(evens) * even);
    ((integral - exact) / exact).abs()
}

#[test]
fn f18_integrals_do_not_drift() {
    // A short version of `cargo xtask soak`.
    let error = drift(10_000_001);
    println!("F18: relative error of the integral after 1e7 samples {error:.1e}");
    // A plain sum is off by 1.7e-11 here.
    assert!(error <= 1e-13, "{error}");
}

#[test]
fn f06_f32_guards_stand_every_exponent_and_sign() {
    let period = 1e-3;
    let a = &[70.0];
    let design = JointDesign { inertia: 1.0, kp: 400.0, kd: 40.0, a, period, form: Form::Observer };
    let limits = Limits::new(Some(30.0), Some(1000.0), period).unwrap();
    let law = JointGains::<f32>::new(&design).unwrap().with_limits(limits);
    let mut state = JointState::new();
    let good = Measurement { q: 0.01_f32, dq: 0.1, tau_applied: 1.0 };
    law.update(&mut state, &good, &Reference::default());
    // A stride that is odd meets every exponent and both signs; all 2^32 are in `cargo xtask soak`.
    let mut bits = 0_u32;
    for _ in 0..=(u32::MAX / 4099) {
        let x = f32::from_bits(bits);
        for m in [
            Measurement { q: x, ..good },
            Measurement { dq: x, ..good },
            Measurement { tau_applied: x, ..good },
        ] {
            let mut next = state;
            let tau = law.update(&mut next, &m, &Reference::default()).tau;
            assert!(tau.is_finite() && tau.abs() <= 30.0, "{bits:#x}: {tau}");
            assert!((tau - state.tau()).abs() <= 1.0 + 1e-5, "{bits:#x}: {tau}");
            if !x.is_finite() {
                assert_eq!(next, state, "{bits:#x}");
            }
        }
        bits = bits.wrapping_add(4099);
    }
}

#[test]
fn the_velocity_filter_is_the_designs_recurrence() {
    let filter = VelocityFilter::<f64>::new(Some(100.0), 1e-3).unwrap();
    let mut state = VelocityState::default();
    let gain = 1.0 - (-core::f64::consts::TAU * 100.0 * 1e-3).exp();
    let (mut dice, mut last, mut want) = (Dice(1), 0.0, 0.0);
    for k in 0..1000 {
        let q = dice.within(-1.0, 1.0);
        let is = filter.estimate(&mut state, q, 1e-3);
        if k > 0 {
            want += gain * ((q - last) / 1e-3 - want);
        }
        assert!((is - want).abs() <= 1e-9 * (1.0 + want.abs()), "{is} {want}");
        last = q;
    }
    assert!(VelocityFilter::<f64>::new(Some(f64::NAN), 1e-3).is_err());
}

#[test]
fn roots_are_within_a_unit_in_the_last_place_in_both_scalars() {
    for k in 0..200_000_u32 {
        // Every exponent in use, and numbers in between.
        let x = f32::from_bits(0x0d80_0000 + k.wrapping_mul(8_993));
        if x.is_finite() && x > 1e-29 {
            let (is, want) = (Real::sqrt(x), x.sqrt());
            assert!(is.to_bits().abs_diff(want.to_bits()) <= 1, "{x:e}: {is:e} against {want:e}");
        }
        let x = f64::from_bits((0x2180_0000_u64 << 32) + u64::from(k) * 0x0000_22f1_3579_bdf1);
        if x.is_finite() && x > 1e-149 {
            let (is, want) = (Real::sqrt(x), x.sqrt());
            assert!(is.to_bits().abs_diff(want.to_bits()) <= 1, "{x:e}: {is:e} against {want:e}");
        }
    }
    let none = |x: f64| Real::sqrt(x).to_bits() == 0;
    assert!(none(-1.0) && none(f64::NAN) && none(f64::INFINITY) && none(0.0));
    let none = |x: f32| Real::sqrt(x).to_bits() == 0;
    assert!(none(-1.0) && none(f32::NAN) && none(f32::INFINITY) && none(0.0));
}

#[test]
fn a_delay_line_is_as_long_as_it_says() {
    for samples in 0..=DELAY_MAX {
        let mut line = Delay::<f64>::new(samples).unwrap();
        for k in 0..40_u32 {
            let want = f64::from((k + 1).saturating_sub(u32::try_from(samples).unwrap()));
            assert!((line.pass(f64::from(k + 1)) - want).abs() < 1e-12, "{samples} at {k}");
        }
    }
    let why = Delay::<f64>::new(DELAY_MAX + 1).unwrap_err();
    assert_eq!(why.to_string(), "a delay of 9 samples; at most 8 are possible");
}

#[test]
fn small_things_say_what_they_are() {
    let mut log = Log::<u8, 2>::new();
    assert!(log.is_empty());
    log.push(1);
    assert!(!log.is_empty());
    log.pop();
    assert!(log.is_empty());
    for (error, words) in [
        (JointMapError::Missing { joint: 3 }, "joint 3 of the controller is not among"),
        (JointMapError::Twice { joint: 2 }, "joint 2 occurs twice"),
    ] {
        assert!(error.to_string().contains(words), "{error}");
    }
    // Joints beyond the shortest of what belongs together are left alone, and the number says so.
    let design = JointDesign {
        inertia: 1.0,
        kp: 1.0,
        kd: 1.0,
        a: &[1.0],
        period: 1e-3,
        form: Form::Observer,
    };
    let law = JointGains::<f64>::new(&design).unwrap();
    let (m, r) = (Measurement { q: 1.0, ..Measurement::default() }, Reference::default());
    for commands in 0..4 {
        let mut told = vec![Command::default(); commands];
        let mut states = [JointState::new(); 3];
        let answered = update_joints(&[law; 3], &mut states, &[m; 3], &[r; 3], &mut told);
        assert_eq!(answered, commands.min(3));
        let moved = states.iter().filter(|s| s.tau().abs() > 0.5).count();
        assert_eq!(moved, answered);
    }
}
