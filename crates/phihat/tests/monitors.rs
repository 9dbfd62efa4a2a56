//! When an arm is stopped, to the sample: the guard's edges, and the monitors against what they state,
//! reckoned from the whole past in place of a recursion. Wrong if one fires early, late or never.
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]

use crate::arm::{Dice, FIRST, SECOND};
use crate::joint::{INERTIA, Joint, T, T_NS, gains};
use phihat::{
    Events, Fault, JointOptions, Limits, Measurement, Mode, ModeRequest, Options, Reference,
};

/// A joint that tracks at rest, so options say what is watched.
fn tracking(joint: JointOptions<f64>, m: Measurement<f64>) -> Joint {
    let mut joint = Joint::new(gains(400.0, 40.0, FIRST), joint, &Options::new(T_NS));
    let r = Reference { q: m.q, ..Reference::default() };
    joint.hold(m, r);
    joint.step(ModeRequest::Track, m, r);
    joint
}

#[test]
fn a_velocity_or_a_step_is_plausible_up_to_its_limit() {
    let options = JointOptions { velocity_max: Some(3.0), ..JointOptions::default() };
    let reach = 3.0 * 2.0 * T;
    for (q, dq, plausible) in [
        (0.0, 3.0, true),
        (0.0, -3.0, true),
        (0.0, 3.0 + 1e-9, false),
        (0.0, -3.0 - 1e-9, false),
        (reach - 1e-12, 0.0, true),
        (-reach + 1e-12, 0.0, true),
        (reach + 1e-9, 0.0, false),
        (-reach - 1e-9, 0.0, false),
        (1.0, 9.0, false),
    ] {
        let mut joint = tracking(options, Measurement::default());
        let m = Measurement { q, dq, tau_applied: 0.0 };
        let told = joint.step(ModeRequest::Track, m, Reference::default()).report;
        assert_eq!(told.events.contains(Events::IMPLAUSIBLE), !plausible, "{q} {dq}");
        assert_eq!((told.misses, told.fault), (u32::from(!plausible), None), "{q} {dq}");
        assert!(!told.events.contains(Events::NOT_FINITE));
    }
    // What is missed is time to move in: so many periods, and one more.
    for missed in 0..6_u32 {
        for (beyond, plausible) in [(-1e-9, true), (1e-9, false)] {
            let mut joint = tracking(options, Measurement::default());
            for _ in 0..missed {
                joint.miss(ModeRequest::Track, Reference::default());
            }
            let q = 3.0 * T * f64::from(missed + 2) + beyond;
            let told = joint.step(
                ModeRequest::Track,
                Measurement { q, ..Measurement::default() },
                Reference::default(),
            );
            let is = !told.report.events.contains(Events::IMPLAUSIBLE);
            assert_eq!(is, plausible, "{missed} missed");
        }
    }
    // Idle or stopped after a gap, the arm may be anywhere; idle without one it may not.
    for (mode, gap, anywhere) in [
        (ModeRequest::Idle, true, true),
        (ModeRequest::Idle, false, false),
        (ModeRequest::Stop, true, true),
        (ModeRequest::Stop, false, false),
    ] {
        let home = Measurement { q: 2.0, ..Measurement::default() };
        let mut joint = if mode == ModeRequest::Stop {
            tracking(options, home)
        } else {
            Joint::new(gains(400.0, 40.0, FIRST), options, &Options::new(T_NS))
        };
        // The first sample of all may be anywhere.
        assert_eq!(joint.step(mode, home, Reference::default()).report.misses, 0);
        joint.step(mode, home, Reference::default());
        if gap {
            joint.miss(mode, Reference::default());
        }
        let m = Measurement { q: -1.5, ..Measurement::default() };
        let told = joint.step(mode, m, Reference::default()).report;
        assert_eq!(told.events.contains(Events::IMPLAUSIBLE), !anywhere, "{mode:?} {gap}");
    }
}

#[test]
fn so_many_bad_samples_or_references_in_a_row_stop_the_arm() {
    let options = JointOptions { velocity_max: Some(3.0), ..JointOptions::default() };
    for spoil in [f64::NAN, 50.0] {
        let mut joint = tracking(options, Measurement::default());
        let bad = Measurement { dq: spoil, ..Measurement::default() };
        // Four are forgiven by a good one.
        for k in 1..=4 {
            let told = joint.step(ModeRequest::Track, bad, Reference::default()).report;
            assert_eq!((told.mode, told.misses), (Mode::Tracking, k));
        }
        joint.step(ModeRequest::Track, Measurement::default(), Reference::default());
        for k in 1..=5 {
            let told = joint.step(ModeRequest::Track, bad, Reference::default()).report;
            let fault = (k == 5).then_some((Fault::BadSample, 0));
            assert_eq!(told.fault, fault, "{k}");
            assert_eq!(told.events.contains(Events::NOT_FINITE), spoil.is_nan());
        }
    }
    let mut joint = tracking(options, Measurement::default());
    let none = Reference { dq: f64::NAN, ..Reference::default() };
    for rows in [19, 20] {
        for k in 1..=rows {
            let told = joint.step(ModeRequest::Track, Measurement::default(), none).report;
            assert!(told.events.contains(Events::REFERENCE_REFUSED));
            assert_eq!(told.fault, (k == 20).then_some((Fault::BadReference, 0)), "{k}");
        }
        joint.step(ModeRequest::Track, Measurement::default(), Reference::default());
    }
    // Where the reference is not heeded it does not matter.
    let mut joint = Joint::new(gains(400.0, 40.0, FIRST), options, &Options::new(T_NS));
    joint.hold(Measurement::default(), none);
    for _ in 0..100 {
        let told = joint.step(ModeRequest::Hold, Measurement::default(), none).report;
        assert_eq!((told.fault, told.mode), (None, Mode::Holding));
    }
}

#[test]
fn the_tracking_error_stops_beyond_its_bound() {
    let options = JointOptions { error_stop: Some(0.125), ..JointOptions::default() };
    for (q, fault) in [(0.125, false), (-0.125, false), (0.125_001, true), (-0.125_001, true)] {
        let mut joint = tracking(options, Measurement::default());
        let m = Measurement { q, ..Measurement::default() };
        let told = joint.step(ModeRequest::Track, m, Reference::default()).report;
        assert_eq!(told.fault, fault.then_some((Fault::TrackingError, 0)), "{q}");
        // Where the law does not run there is no error.
        let mut armed = Joint::new(gains(400.0, 40.0, FIRST), options, &Options::new(T_NS));
        armed.step(ModeRequest::Arm, Measurement::default(), Reference::default());
        assert_eq!(armed.step(ModeRequest::Arm, m, Reference::default()).report.fault, None);
    }
}

/// Wrong if one or two bad readings stop an arm, if three do not, or if the share shown is another one.
#[test]
fn an_error_beyond_its_certified_bound_stops_after_three_samples() {
    let options = JointOptions {
        error_bound: Some(0.125),
        error_stop: Some(0.25),
        ..JointOptions::default()
    };
    for (q, leaves) in [(0.125, false), (-0.125, false), (0.125_001, true), (-0.125_001, true)] {
        let mut joint = tracking(options, Measurement::default());
        let m = Measurement { q, ..Measurement::default() };
        for k in 1..=8 {
            let told = joint.step(ModeRequest::Track, m, Reference::default()).report;
            // The third sample beyond is answered, and the next one stops.
            let stops = leaves && k >= 4;
            assert_eq!(told.fault, stops.then_some((Fault::ErrorBound, 0)), "{q} {k}");
            let share = if stops { 0.0 } else { q.abs() / 0.125 };
            assert!((f64::from(told.error_share) - share).abs() < 1e-6, "{told:?}");
        }
        // Two beyond and one inside, for ever.
        let mut joint = tracking(options, Measurement::default());
        for k in 0..30 {
            let m = if k % 3 == 2 { Measurement::default() } else { m };
            assert_eq!(joint.step(ModeRequest::Track, m, Reference::default()).report.fault, None);
        }
    }
    let mut joint = tracking(JointOptions::default(), Measurement::default());
    let m = Measurement { q: 0.2, ..Measurement::default() };
    let told = joint.step(ModeRequest::Track, m, Reference::default()).report;
    assert_eq!((told.fault, told.error_share.to_bits()), (None, 0));
}

#[test]
fn inside_the_dead_zone_at_rest_the_estimate_is_held() {
    let options = JointOptions { dead_zone: Some(0.01), ..JointOptions::default() };
    for (e, speed, held) in [
        (0.009, 0.0, true),
        (-0.009, 0.0, true),
        (0.011, 0.0, false),
        (-0.011, 0.0, false),
        (0.009, 0.1, false),
    ] {
        let m = Measurement { q: 0.5, ..Measurement::default() };
        let mut joint = tracking(options, m);
        let at = Reference { q: 0.5 - e, dq: speed, ddq: 0.0 };
        for _ in 0..600 {
            joint.step(ModeRequest::Track, m, at);
        }
        let before = joint.state.joints[0].phi_hat();
        let pushed = Measurement { tau_applied: 30.0, ..m };
        let told = joint.step(ModeRequest::Track, pushed, at);
        let moved = (told.commands[0].phi_hat - before).abs();
        assert_eq!(told.report.events.contains(Events::DEAD_ZONE), held, "{e} {speed}");
        assert!(if held { moved < 1e-12 } else { moved > 0.5 }, "{e} {speed}: {moved}");
    }
}

#[test]
fn a_position_that_stands_while_it_should_move_is_frozen_after_its_travel() {
    // Speed that is measured, speed of the reference, of which a fifth counts.
    for (dq, asked) in [(0.5_f64, 0.0), (-0.5, 0.0), (0.0, 2.0), (0.3, 2.0), (0.5, 2.0), (3.0, 0.0)]
    {
        let options = JointOptions { frozen_travel: Some(4e-3), ..JointOptions::default() };
        let mut joint = tracking(options, Measurement::default());
        let speed = dq.abs().max(0.2_f64 * asked);
        let mut q = 0.01;
        // While it moves, however little, nothing is frozen.
        for _ in 0..50 {
            q += 1e-9;
            let m = Measurement { q, dq, tau_applied: 0.0 };
            let r = Reference { q, dq: asked, ddq: 0.0 };
            assert_eq!(joint.step(ModeRequest::Track, m, r).report.fault, None);
        }
        let m = Measurement { q, dq, tau_applied: 0.0 };
        let r = Reference { q, dq: asked, ddq: 0.0 };
        let found = (1..100).find(|_| joint.step(ModeRequest::Track, m, r).report.fault.is_some());
        // Five samples at least.
        let want = (1..100).find(|n| *n >= 5 && f64::from(*n) * speed * T > 4e-3 + 1e-12);
        // The blended reference moves by itself at first: a sample more or less.
        let near = found.zip(want).is_some_and(|(is, want): (i32, i32)| (is - want).abs() <= 1);
        assert!(near, "{dq} {asked}: {found:?} against {want:?}");
        assert_eq!(joint.state.arm.mode(), Mode::SafeStop);
    }
    // Beyond its travel, and not at it.
    let travel = (0..8).fold(0.0, |sum, _| sum + 0.5 * (T_NS as f64 * 1e-9));
    for (share, samples) in [(1.0, 9), (1.0 - 1e-15, 8), (1.0 + 1e-15, 9)] {
        let frozen_travel = Some(share * travel);
        let options = JointOptions { frozen_travel, ..JointOptions::default() };
        let m = Measurement { dq: 0.5, ..Measurement::default() };
        let mut joint = tracking(options, Measurement { q: 0.01, ..Measurement::default() });
        joint.step(ModeRequest::Track, m, Reference::default());
        let found = (1..20).find(|_| {
            joint.step(ModeRequest::Track, m, Reference::default()).report.fault.is_some()
        });
        assert_eq!(found, Some(samples), "{share}");
    }
}

/// Torque demands so far; whether the arm has to be stopped by them.
fn shakes(demands: &[f64], threshold: f64) -> bool {
    let second: Vec<f64> = demands.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]).collect();
    let hot = |upto: usize| {
        let past = &second[..upto];
        let weights = std::iter::successors(Some(1.0 / 16.0), |w| Some(w * 15.0 / 16.0));
        let square: f64 = past.iter().rev().zip(weights).map(|(d, w)| w * d * d).sum();
        let up: Vec<bool> = past.iter().rev().take(32).map(|d| *d > 0.0).collect();
        let changes = up.windows(2).filter(|w| w[0] != w[1]).count();
        square > threshold * threshold && changes >= 5
    };
    second.len() >= 8 && (0..8).all(|back| hot(second.len() - back))
}

#[test]
fn an_oscillation_is_found_at_the_sample_that_its_rule_says() {
    let mut dice = Dice(31);
    let (mut found, mut quiet) = (0, 0);
    for run in 0..120 {
        let options = JointOptions { oscillation: Some(3.0), ..JointOptions::default() };
        let mut joint = Joint::new(gains(400.0, 40.0, FIRST), options, &Options::new(T_NS));
        joint.step(ModeRequest::Arm, Measurement::default(), Reference::default());
        // Before the law runs the demand is what is held: nothing.
        let mut demands = vec![0.0, 0.0];
        let (size, every) = (10.0_f64.powf(dice.within(-3.5, -1.5)), 1 + run % 12);
        let (from, to) = (dice.bits() % 40, 60 + dice.bits() % 100);
        let period = dice.within(10.0, 16.0);
        let mut stopped = None;
        for k in 0..200_u64 {
            // Steps to and fro every so many samples, for a while; sometimes at random.
            let up = if run % 3 == 0 {
                dice.bits().is_multiple_of(2)
            } else {
                (k / every).is_multiple_of(2)
            };
            let q = match run % 4 {
                // Slowly, about as often as is an oscillation.
                1 => 60.0 * size * (core::f64::consts::TAU * k as f64 / period).sin(),
                _ if (from..to).contains(&k) && up => size,
                _ => 0.0,
            };
            let m = Measurement { q, dq: 0.0, tau_applied: 0.0 };
            let answer = joint.step(ModeRequest::Hold, m, Reference::default());
            if answer.report.fault.is_some() {
                assert_eq!(answer.report.fault, Some((Fault::Oscillation, 0)));
                stopped = Some(k);
                break;
            }
            // Seen at a sample, a fault at the next.
            assert!(!shakes(&demands, 3.0), "run {run} sample {k}: missed");
            demands.push(answer.commands[0].tau);
        }
        assert_eq!(stopped.is_some(), shakes(&demands, 3.0), "run {run}: {stopped:?}");
        found += u32::from(stopped.is_some());
        quiet += u32::from(stopped.is_none());
    }
    println!("{found} oscillations, {quiet} without");
    assert!(found > 20 && quiet > 20, "{found} {quiet}");
}

/// Covariance of torques and velocity steps of the past, and variance of the torques: means over all samples
/// at first, over some 16 later.
pub(crate) fn spread(past: &[(f64, f64)]) -> (f64, f64) {
    // From the last sample back: what the later ones leave of each. Beyond 700 that is less than rounding.
    let mut left = 1.0;
    let weights: Vec<f64> = (1..=past.len())
        .rev()
        .take(700)
        .map(|n| {
            let rate = 1.0 / n.min(16) as f64;
            let weight = left * rate;
            left *= 1.0 - rate;
            weight
        })
        .collect();
    let weighted = |f: &dyn Fn(&(f64, f64)) -> f64| -> f64 {
        past.iter().rev().zip(&weights).map(|(p, w)| w * f(p)).sum()
    };
    let (torque, step) = (weighted(&|p| p.0), weighted(&|p| p.1));
    let both = weighted(&|p| (p.0 - torque) * (p.1 - step));
    (both, weighted(&|p| (p.0 - torque).powi(2)))
}

/// Returns true if the last samples show a drive that does not push.
fn suspicious(past: &[(f64, f64)], excitation: f64) -> bool {
    let (both, square) = spread(past);
    // A twentieth of what the nominal inertia would do.
    square > excitation * excitation && both < 0.05 * T / INERTIA * square
}

#[test]
fn a_drive_is_judged_at_the_sample_that_its_rule_says() {
    let mut dice = Dice(22);
    let (mut found, mut healthy) = (0, 0);
    for run in 0..150 {
        let options = JointOptions { first_motion: Some(2.0), ..JointOptions::default() };
        let mut joint = Joint::new(gains(400.0, 40.0, SECOND), options, &Options::new(T_NS));
        joint.step(ModeRequest::Arm, Measurement::default(), Reference::default());
        let drive = [1.0, 0.0, -1.0, 0.06, 0.04][run % 5];
        let (size, begin) = (10.0_f64.powf(dice.within(-0.5, 1.5)), dice.bits() % 300);
        let mut past: Vec<(f64, f64)> = Vec::new();
        let (mut row, mut stopped, mut expected) = (0, None, None);
        let mut m = Measurement::default();
        for k in 0..400_u64 {
            m.tau_applied = if k < begin { 0.0 } else { size * dice.within(-1.0, 1.0) };
            let step = T / INERTIA * drive * m.tau_applied;
            m.dq += step;
            let answer = joint.step(ModeRequest::Hold, m, Reference::default());
            if answer.report.fault.is_some() {
                assert_eq!(answer.report.fault, Some((Fault::Actuation, 0)));
                stopped = Some(k);
                break;
            }
            // During the first quarter of a second, but not while what held the arm before may still act.
            if (10..250).contains(&k) {
                past.push((m.tau_applied, step));
                row = if suspicious(&past, 2.0) { row + 1 } else { 0 };
                if row >= 15 && expected.is_none() {
                    expected = Some(k + 1);
                }
            }
        }
        assert_eq!(stopped, expected, "run {run}: drive {drive}, {size} N·m from {begin}");
        found += u32::from(stopped.is_some());
        healthy += u32::from(stopped.is_none());
    }
    println!("{found} drives found, {healthy} not");
    assert!(found > 20 && healthy > 40, "{found} {healthy}");
}

/// Whatever an arm does that was not seen for long, it is to be stopped; an arm in motion is judged all the
/// same, and so is the first sample of all.
#[test]
fn after_a_hundred_samples_missed_a_stopped_arm_may_be_as_fast_as_it_is() {
    let options = JointOptions { velocity_max: Some(3.0), ..JointOptions::default() };
    let fast = Measurement { q: 0.4, dq: 9.0, tau_applied: 0.0 };
    let implausible = |joint: &mut Joint, mode| {
        let told = joint.step(mode, fast, Reference::default()).report;
        told.events.contains(Events::IMPLAUSIBLE)
    };
    for (missed, refused) in [(1, true), (99, true), (100, true), (101, false), (200, false)] {
        let mut joint = tracking(options, Measurement::default());
        joint.step(ModeRequest::Stop, Measurement::default(), Reference::default());
        for _ in 0..missed {
            joint.miss(ModeRequest::Stop, Reference::default());
        }
        assert_eq!(implausible(&mut joint, ModeRequest::Stop), refused, "{missed} missed");
    }
    // It tracks on for as long as it may.
    let patient = Options { stop_samples: 1000, lost_max: 64, ..Options::new(T_NS) };
    let mut joint = Joint::new(gains(400.0, 40.0, FIRST), options, &patient);
    joint.hold(Measurement::default(), Reference::default());
    for _ in 0..200 {
        joint.miss(ModeRequest::Hold, Reference::default());
    }
    assert_eq!(joint.state.arm.mode(), Mode::Holding);
    assert!(implausible(&mut joint, ModeRequest::Hold));
    let mut first = Joint::new(gains(400.0, 40.0, FIRST), options, &Options::new(T_NS));
    assert!(implausible(&mut first, ModeRequest::Idle));
}

/// A joint that is fast already may be twice as fast at the next sample: that is a fault to act on, not a
/// sample to refuse.
#[test]
fn a_joint_that_is_fast_may_become_twice_as_fast() {
    let options = JointOptions { velocity_max: Some(3.0), ..JointOptions::default() };
    for (before, limit) in [(0.0, 3.0), (1.4, 3.0), (2.5, 5.0), (-2.5, 5.0)] {
        for (share, plausible) in [(0.999, true), (1.001, false), (-0.999, true), (-1.001, false)] {
            // By its velocity, and by how far it went in the two periods that a stamp may be off by.
            for (dq, gone) in [(share * limit, 0.0), (0.0, share * limit * 2.0 * T)] {
                let mut joint = tracking(options, Measurement::default());
                let mut m = Measurement { dq: before, ..Measurement::default() };
                joint.step(ModeRequest::Track, m, Reference::default());
                m = Measurement { q: m.q + gone, dq, ..m };
                let told = joint.step(ModeRequest::Track, m, Reference::default()).report;
                let refused = told.events.contains(Events::IMPLAUSIBLE);
                assert_eq!(refused, !plausible, "{before} rad/s, then {dq} and {gone} rad");
            }
        }
    }
}

/// A joint is too fast beyond its limit, for three samples in a row; one may be noise.
#[test]
fn a_joint_is_stopped_at_the_third_sample_beyond_its_speed() {
    let options = JointOptions { velocity_max: Some(3.0), ..JointOptions::default() };
    let run = |speeds: &[f64]| {
        let mut joint = tracking(options, Measurement::default());
        let mut m = Measurement { dq: 2.9, ..Measurement::default() };
        joint.step(ModeRequest::Track, m, Reference::default());
        speeds.iter().position(|dq| {
            m.dq = *dq;
            let fault = joint.step(ModeRequest::Track, m, Reference::default()).report.fault;
            assert!(fault.is_none_or(|fault| fault == (Fault::Overspeed, 0)));
            fault.is_some()
        })
    };
    assert_eq!(run(&[3.1, 3.1, 3.1]), Some(2));
    assert_eq!(run(&[-3.1, 4.0, -3.1, 3.1]), Some(2));
    assert_eq!(run(&[3.1, 3.1, 3.0, 3.1, 3.1, 2.0, 3.1, 3.1]), None);
    assert_eq!(run(&[3.0; 20]), None, "at the limit is within it");
    assert_eq!(run(&[-3.0; 20]), None);
}

/// Half of the torque limit beyond what was commanded lately, on both sides; what is further off is none that
/// the drive can give.
#[test]
fn a_measured_torque_is_believed_near_what_was_commanded_lately() {
    let law = gains(400.0, 40.0, FIRST).with_limits(Limits::new(Some(20.0), None, T).unwrap());
    // At 0.02 rad of error, 5.6 N·m, from one sample on; before, nothing; then less again.
    let commanded = |samples: u32, less: u32| {
        let mut joint = Joint::new(law, JointOptions::default(), &Options::new(T_NS));
        joint.hold(Measurement::default(), Reference::default());
        let m = Measurement { q: -0.02, dq: 0.0, tau_applied: 0.0 };
        let mut range = [0.0_f64; 2];
        let mut tau = 0.0;
        for k in 0..samples + less {
            let share = if k < samples { 1.0 } else { 0.3 };
            let m = Measurement { q: share * m.q, tau_applied: tau, ..m };
            tau = joint.step(ModeRequest::Hold, m, Reference::default()).commands[0].tau;
            // What was commanded long ago does not act any more: a thirty-second is forgotten per sample.
            range = range.map(|end| end + (tau - end) / 32.0);
            range = [range[0].min(tau), range[1].max(tau)];
        }
        (joint, m, range)
    };
    for (samples, less) in [(1, 0), (20, 0), (200, 0), (30, 10)] {
        let (_, _, [low, high]) = commanded(samples, less);
        assert!(high > low);
        let slack = 10.0 + (high - low);
        for (tau_applied, believed) in [
            (high + slack - 1e-6, true),
            (high + slack + 1e-6, false),
            (low - slack + 1e-6, true),
            (low - slack - 1e-6, false),
            (1e6, false),
            (-1e6, false),
        ] {
            let (mut joint, m, _) = commanded(samples, less);
            let last = joint.state.joints[0].tau();
            let mut other = joint.state;
            let answer = joint.step(
                ModeRequest::Hold,
                Measurement { tau_applied, ..m },
                Reference::default(),
            );
            let refused = answer.report.events.contains(Events::TORQUE_REFUSED);
            assert_eq!(refused, !believed, "{samples}: {tau_applied} in {low} … {high}");
            // What is not believed counts as what was commanded last.
            core::mem::swap(&mut joint.state, &mut other);
            joint.k -= 1;
            let m = Measurement { tau_applied: last, ..m };
            let as_told = joint.step(ModeRequest::Hold, m, Reference::default());
            let phi_hat = [answer, as_told].map(|answer| answer.commands[0].phi_hat.to_bits());
            let same = phi_hat[0] == phi_hat[1];
            assert_eq!(same, !believed, "{samples}: {tau_applied}");
        }
    }
}

/// Without a torque limit what the outer loop gives at 1 rad is the slack.
#[test]
fn without_a_torque_limit_a_torque_is_believed_within_what_the_outer_loop_gives_at_one_radian() {
    for (tau_applied, believed) in [(279.9, true), (-279.9, true), (280.1, false), (-280.1, false)]
    {
        let mut joint = tracking(JointOptions::default(), Measurement::default());
        let m = Measurement { tau_applied, ..Measurement::default() };
        let told = joint.step(ModeRequest::Track, m, Reference::default()).report.events;
        assert_eq!(told.contains(Events::TORQUE_REFUSED), !believed, "{tau_applied}");
    }
}
