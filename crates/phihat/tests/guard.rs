//! Samples that the guard admits. Wrong if a bad, late, lost, stale, frozen or wrapped sample moves the arm
//! more than its bar, if good ones are refused, or if a torque is not finite and within limits.
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "small positive numbers"
)]

use crate::arm::{Arm, Dice, FIRST, SECOND, T, T_NS, at};
use phihat::{Events, Fault, JointOptions, Measurement, Mode, Reference, Stamp, Unwrap};

fn wave(t: f64) -> Reference<f64> {
    let (amplitude, w) = (0.4, 2.0);
    let (s, c) = (w * t).sin_cos();
    Reference { q: amplitude * (1.0 - c), dq: amplitude * w * s, ddq: amplitude * w * w * c }
}

/// An arm in the middle of a motion under load, settled.
fn moving<const N: usize>(a: &[f64], joint: JointOptions<f64>) -> (Arm<N>, f64) {
    let mut arm = Arm::<N>::new(a, joint);
    for joint in &mut arm.truth {
        joint.load = 20.0;
    }
    arm.start();
    let begin = arm.time();
    for _ in 0..1300 {
        let r = wave(arm.time() - begin);
        arm.step(&[r; N]);
    }
    (arm, begin)
}

fn plausible() -> JointOptions<f64> {
    JointOptions {
        velocity_max: Some(3.0),
        frozen_travel: Some(1e-3),
        error_stop: Some(0.1),
        oscillation: Some(3.0),
        ..JointOptions::default()
    }
}

#[test]
fn f04_misses_are_held_then_stopped_and_counted() {
    for a in [FIRST, SECOND] {
        for run in [0_u64, 1, 2, 3, 5, 10, 19, 20, 50, 100] {
            let (mut arm, begin) = moving::<1>(a, plausible());
            let stamp = arm.sense().stamp;
            let (mut peak, mut stopped_after) = (0.0_f64, None);
            for k in 0..1500 {
                let r = wave(arm.time() - begin);
                let mut seen = arm.sense();
                if k < run {
                    // The last sample again, as a driver that waits hands it out.
                    seen.stamp = Stamp { sequence: stamp.sequence - 1, t_ns: stamp.t_ns - T_NS };
                    seen.joints = [Measurement { q: f64::NAN, ..seen.joints[0] }];
                }
                let error = (arm.truth[0].q - r.q).abs();
                let answer = arm.step_with(&seen, &[r]);
                if k < run {
                    assert_eq!(u64::from(answer.report.misses), k + 1);
                    assert!(answer.report.events.contains(Events::MISSED));
                }
                if answer.report.fault.is_some() && stopped_after.is_none() {
                    stopped_after = Some(k + 1);
                    assert_eq!(answer.report.fault, Some((Fault::LinkLost, 0)));
                }
                peak = peak.max(error);
                if stopped_after.is_some() {
                    break;
                }
            }
            let wanted = (run >= 20).then_some(20);
            assert_eq!(stopped_after, wanted, "{run} misses");
            println!("F4: m = {}, {run} misses: peak error {peak:.1e} rad", a.len());
            assert!(peak < if run <= 5 { 1e-4 } else { 1e-2 }, "{run} misses: {peak}");
        }
    }
}

#[test]
fn f04_jitter_is_integrated_with_the_measured_time() {
    // Samples come up to 90 % early or late, stamped when they were taken.
    let peak = |jitter: f64| {
        let (mut arm, begin) = moving::<1>(SECOND, plausible());
        let mut dice = Dice(4);
        let mut peak = 0.0_f64;
        let (mut t_ns, mut last_tau) = (arm.k * T_NS, arm.truth[0].tau);
        for k in 0..3000_u64 {
            let sequence = arm.k;
            let dt_ns = (T_NS as f64 * (1.0 + jitter * dice.within(-1.0, 1.0))) as u64;
            let t = t_ns as f64 * 1e-9;
            let r = wave(t - begin);
            let joint = &mut arm.truth[0];
            let m = Measurement { q: joint.q, dq: joint.dq, tau_applied: last_tau };
            let seen =
                crate::arm::Seen { stamp: Stamp { sequence, t_ns }, now_ns: t_ns, joints: [m] };
            let (q, dq) = (joint.q, joint.dq);
            let answer = arm.step_with(&seen, &[r]);
            assert!(answer.report.fault.is_none(), "{:?}", answer.report);
            let dt = dt_ns as f64 * 1e-9;
            let joint = &mut arm.truth[0];
            last_tau = answer.commands[0].tau;
            let ddq = (last_tau - joint.load) / joint.inertia;
            (joint.q, joint.dq) = (q + dt * dq + 0.5 * dt * dt * ddq, dq + dt * ddq);
            if k > 500 {
                peak = peak.max((q - r.q).abs());
            }
            t_ns += dt_ns;
        }
        peak
    };
    let (clean, rough) = (peak(0.0), peak(0.9));
    println!("F4: peak error without jitter {clean:.1e} rad, with ±90 % {rough:.1e} rad");
    assert!(rough < 3.0 * clean.max(1e-4), "{rough} against {clean}");
}

#[test]
fn f19_clock_jumps_duplicates_and_bad_intervals_integrate_nothing() {
    let hour = 3_600_000_000_000_u64;
    let jumps: [(&str, i64); 7] = [
        ("an hour ahead", hour.cast_signed()),
        ("an hour back", -hour.cast_signed()),
        ("no time", -(T_NS.cast_signed())),
        ("one nanosecond", 1 - T_NS.cast_signed()),
        ("backwards by two samples", -3 * T_NS.cast_signed()),
        ("ten seconds", 10_000_000_000),
        ("the end of time", i64::MAX),
    ];
    for (name, jump) in jumps {
        let (mut arm, _) = moving::<1>(SECOND, plausible());
        let mut offset = 0_i64;
        let mut last = None;
        for k in 0..400_u64 {
            if k == 200 {
                offset = jump;
            }
            let r = wave(1.3 + k as f64 * T);
            let mut seen = arm.sense();
            seen.stamp.t_ns = (seen.stamp.t_ns + 2 * hour).saturating_add_signed(offset);
            seen.now_ns = seen.stamp.t_ns;
            let before = arm.state.joints[0];
            let answer = arm.step_with(&seen, &[r]);
            if k == 200 {
                let step: f64 = answer.commands[0].tau - last.unwrap_or(0.0);
                assert!(step.abs() < 0.2, "{name}: torque step {step}");
                let moved = (answer.commands[0].phi_hat - before.phi_hat()).abs();
                assert!(moved < 1e-12, "{name}: the estimate moved by {moved}");
                assert!(answer.report.events.contains(Events::TIME_JUMP), "{name}");
            }
            last = Some(answer.commands[0].tau);
            assert!(answer.report.fault.is_none(), "{name}: {:?}", answer.report);
        }
    }
}

#[test]
fn f05_a_frozen_sensor_is_detected_and_the_arm_stays_near() {
    for freeze in [1_u64, 5, 20, 50, 200] {
        let (mut arm, begin) = moving::<1>(SECOND, plausible());
        let frozen = arm.sense();
        let (mut peak, mut found) = (0.0_f64, None);
        for k in 0..300_u64 {
            let r = wave(arm.time() - begin);
            let mut seen = arm.sense();
            if k < freeze {
                // The sequence number goes on: the fieldbus lives, the encoder does not.
                seen.joints = frozen.joints;
            }
            let error = (arm.truth[0].q - r.q).abs();
            let answer = arm.step_with(&seen, &[r]);
            if let (Some((fault, _)), None) = (answer.report.fault, found) {
                assert_eq!(fault, Fault::Frozen, "{freeze} ms");
                found = Some(k + 1);
            }
            if k < 40 {
                peak = peak.max(error);
            }
        }
        println!(
            "F5: frozen {freeze} ms: found after {found:?} samples, peak error {peak:.1e} rad"
        );
        assert!(peak <= 0.03, "{peak}");
        assert_eq!(found.is_some(), freeze >= 20, "{freeze} ms");
        assert!(found.is_none_or(|k| k <= 20));
    }
}

#[test]
fn f05_no_false_alarm_at_rest_or_in_motion() {
    // Quantised to 20 bits, a second of motion, a second of rest, in a short version of 1e7 samples.
    let mut arm = Arm::<1>::new(SECOND, plausible());
    arm.truth[0].load = 20.0;
    arm.start();
    let begin = arm.k;
    let quantum = core::f64::consts::TAU / f64::from(1 << 20);
    for _ in 0..300_000_u64 {
        let k = (arm.k - begin) % 4000;
        let forth = k < 2000;
        let s = ((k % 2000) as f64 * T).min(1.0);
        let x = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        let (dx, ddx) =
            (30.0 * s * s * (1.0 - s) * (1.0 - s), 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s));
        let (x, dx, ddx) = if forth { (x, dx, ddx) } else { (1.0 - x, -dx, -ddx) };
        let mut seen = arm.sense();
        seen.joints[0].q = quantum * (seen.joints[0].q / quantum).round();
        let answer = arm.step_with(&seen, &at(0.4 * x, 0.4 * dx, 0.4 * ddx));
        assert!(answer.report.fault.is_none(), "sample {}: {:?}", arm.k, answer.report);
    }
}

#[test]
fn f06_nan_infinity_and_any_bits_never_become_torque() {
    let mut dice = Dice(6);
    let (mut arm, begin) = moving::<2>(SECOND, plausible());
    // One bad sample leaves no trace in any joint.
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 50.0] {
        let before = arm.state.joints;
        let mut seen = arm.sense();
        seen.joints[1].q = bad;
        let r = wave(arm.time() - begin);
        let answer = arm.step_with(&seen, &[r; 2]);
        for (joint, before) in arm.state.joints.iter().zip(&before) {
            assert_eq!(joint.phi_hat().to_bits(), before.phi_hat().to_bits());
            assert_eq!(joint.tau().to_bits(), before.tau().to_bits());
        }
        assert!(answer.report.events.contains(Events::MISSED));
        let r = wave(arm.time() - begin);
        assert!(arm.step(&[r; 2]).report.fault.is_none());
    }
    // Any bits at all, in any field, in any mode.
    let requests = [
        phihat::ModeRequest::Idle,
        phihat::ModeRequest::Arm,
        phihat::ModeRequest::Hold,
        phihat::ModeRequest::Track,
        phihat::ModeRequest::Stop,
    ];
    let mut last = [0.0; 2];
    for (joint, tau) in arm.state.joints.iter().zip(&mut last) {
        *tau = joint.tau();
    }
    for case in 0..300_000_u64 {
        let mut wild = |good: f64| {
            if dice.bits().is_multiple_of(6) { f64::from_bits(dice.bits()) } else { good }
        };
        let mut seen = arm.sense();
        for m in &mut seen.joints {
            *m = Measurement { q: wild(m.q), dq: wild(m.dq), tau_applied: wild(m.tau_applied) };
        }
        let references =
            [(); 2].map(|()| Reference { q: wild(0.1), dq: wild(0.0), ddq: wild(0.0) });
        if !dice.bits().is_multiple_of(3) {
            seen = arm.sense();
        }
        if dice.bits().is_multiple_of(50) {
            arm.mode = requests[(dice.bits() % 5) as usize];
        }
        let answer = arm.step_with(&seen, &references);
        for (joint, (command, last)) in answer.commands.iter().zip(&mut last).enumerate() {
            let tau = command.tau;
            assert!(tau.is_finite() && tau.abs() <= 87.0, "case {case} joint {joint}: {tau}");
            assert!(
                (tau - *last).abs() <= 1.0 + 1e-12,
                "case {case} joint {joint}: {last} → {tau}"
            );
            *last = tau;
        }
        // Truth is kept where an arm can be.
        for joint in &mut arm.truth {
            if joint.q.abs() > 5.0 || joint.dq.abs() > 5.0 {
                (joint.q, joint.dq) = (0.0, 0.0);
            }
        }
    }
}

#[test]
fn f08_a_wrap_is_undone_at_the_boundary() {
    // A continuous joint turns both ways through ±π, read with three quanta of noise.
    let quantum = core::f64::consts::TAU / f64::from(1 << 20);
    let mut dice = Dice(8);
    let (mut raw, mut angle) = (0.0_f64, Unwrap::new());
    let (mut true_angle, mut worst, mut crossings) = (3.0_f64, 0.0_f64, 0_u32);
    angle.take(3.0);
    for k in 0..1_000_000_u64 {
        // Hovers about π, or turns fast.
        let step = if (k / 5000) % 2 == 0 { dice.within(-5.0, 5.0) * quantum } else { 2.9e-3 };
        let pi = core::f64::consts::PI;
        let odd = pi * (2.0 * ((true_angle / pi - 1.0) / 2.0).round() + 1.0);
        let pull = if (k / 5000) % 2 == 0 { 0.01 * (odd - true_angle) } else { 0.0 };
        true_angle += pull + if (k / 100_000) % 2 == 0 { step } else { -step };
        let noisy = true_angle + (dice.within(-3.0, 3.0)).round() * quantum;
        let wrapped = noisy - core::f64::consts::TAU * (noisy / core::f64::consts::TAU).round();
        crossings += u32::from((wrapped - raw).abs() > 3.0);
        raw = wrapped;
        worst = worst.max((angle.take(wrapped) - noisy).abs());
    }
    println!("F8: {crossings} crossings, largest deviation {worst:.1e} rad");
    assert!(worst < 1e-9 && crossings > 10_000);
}

#[test]
fn f08_a_jump_of_a_turn_on_a_revolute_joint_is_a_fault() {
    let (mut arm, begin) = moving::<1>(SECOND, plausible());
    let mut fault = None;
    let mut peak = 0.0_f64;
    let holding = arm.truth[0].tau;
    for _ in 0..30 {
        let mut seen = arm.sense();
        seen.joints[0].q -= core::f64::consts::TAU;
        let r = wave(arm.time() - begin);
        let answer = arm.step_with(&seen, &[r]);
        fault = fault.or(answer.report.fault);
        if fault.is_none() {
            peak = peak.max((answer.commands[0].tau - holding).abs());
        }
    }
    assert_eq!(fault, Some((Fault::BadSample, 0)));
    assert!(peak < 1e-12, "the torque is held until the arm stops: {peak}");
    assert_eq!(arm.state.arm.mode(), Mode::SafeStop);
}

#[test]
fn f20_loss_reorder_and_duplicates_never_step_the_torque() {
    let mut dice = Dice(20);
    for loss in [0.0, 0.05, 0.2, 0.5, 1.0] {
        let (mut arm, begin) = moving::<1>(SECOND, plausible());
        let mut line = std::collections::VecDeque::new();
        let (mut worst, mut last, mut fault) = (0.0_f64, arm.truth[0].tau, None);
        let mut held = arm.sense();
        for _ in 0..2000 {
            let now = arm.sense();
            line.push_back(now);
            // Now and then two samples change places, or one comes twice.
            if line.len() > 2 && dice.bits().is_multiple_of(20) {
                line.swap(0, 1);
            }
            let mut seen = line.pop_front().unwrap();
            if dice.within(0.0, 1.0) < loss {
                // Lost: the last one is handed out again.
                seen = held;
            }
            held = seen;
            seen.now_ns = now.now_ns;
            let r = wave(arm.time() - begin);
            let answer = arm.step_with(&seen, &[r]);
            fault = fault.or(answer.report.fault);
            worst = worst.max((answer.commands[0].tau - last).abs());
            last = answer.commands[0].tau;
        }
        println!("F20: loss {loss}: torque step {worst:.3} N·m, fault {fault:?}");
        assert!(worst <= 1.0 + 1e-9);
        match loss {
            l if l < 0.1 => assert_eq!(fault, None),
            l if l >= 0.5 => assert!(fault.is_some()),
            _ => {}
        }
    }
}
