//! Fresh samples, and the time over which they are integrated. Wrong at the edges of the rules that the
//! options state: age, window of sequence numbers, shortest and longest interval, samples lost of
//! the last 64.
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]

use crate::arm::{Arm, FIRST, T, T_NS, at};
use phihat::{Events, Fault, JointOptions, Mode, ModeRequest, Options, Report};

/// An arm that tracks at rest under a load it knows.
fn tracking(options: &Options) -> Arm<1> {
    let mut arm = Arm::<1>::with(FIRST, JointOptions::default(), options);
    arm.truth[0].load = 5.0;
    arm.start();
    for _ in 0..100 {
        arm.step(&at(0.0, 0.0, 0.0));
    }
    arm
}

/// One sample whose stamp is changed; the sample that is right comes next.
fn spoilt(arm: &mut Arm<1>, change: impl Fn(&mut crate::arm::Seen<1>)) -> Report {
    let mut seen = arm.sense();
    change(&mut seen);
    arm.step_with(&seen, &at(0.0, 0.0, 0.0)).report
}

#[test]
fn a_sample_is_used_up_to_the_age_limit_and_no_longer() {
    for age_max_ns in [1, T_NS / 3, 3 * T_NS] {
        let options = Options { age_max_ns, ..Options::new(T_NS) };
        for (age, fresh) in
            [(0, true), (age_max_ns - 1, true), (age_max_ns, true), (age_max_ns + 1, false)]
        {
            let mut arm = tracking(&options);
            let told = spoilt(&mut arm, |seen| seen.now_ns = seen.stamp.t_ns + age);
            assert_eq!(told.misses, u32::from(!fresh), "{age} of {age_max_ns} ns");
            assert_eq!(told.events.contains(Events::AGED), !fresh);
            assert_eq!(told.events.contains(Events::MISSED), !fresh);
        }
        // A sample from the future, by the clock, has no age.
        let mut arm = tracking(&options);
        assert_eq!(spoilt(&mut arm, |seen| seen.now_ns = 0).misses, 0);
    }
    // The first sample of all is judged, too: an arm does not arm on an old one.
    let mut arm = Arm::<1>::new(FIRST, JointOptions::default());
    arm.mode = ModeRequest::Arm;
    let told = spoilt(&mut arm, |seen| seen.now_ns = seen.stamp.t_ns + 3 * T_NS + 1);
    assert_eq!((told.mode, told.events.contains(Events::AGED)), (Mode::Idle, true));
}

#[test]
fn a_sequence_number_counts_within_its_window() {
    let options = Options { sequence_window: 50, ..Options::new(T_NS) };
    for (advance, event) in [
        (0, Events::DUPLICATE),
        (1, Events::NONE),
        (50, Events::NONE),
        (51, Events::REORDERED),
        (u64::MAX, Events::REORDERED),
        (1_u64 << 63, Events::REORDERED),
    ] {
        let mut arm = tracking(&options);
        let last = arm.sense().stamp.sequence - 1;
        let told = spoilt(&mut arm, |seen| seen.stamp.sequence = last.wrapping_add(advance));
        let refused = !event.is_empty();
        assert_eq!(told.misses, u32::from(refused), "advance {advance}");
        let own = Events::DUPLICATE | Events::REORDERED;
        assert_eq!(told.events.bits() & own.bits(), event.bits(), "advance {advance}");
        assert!(!told.events.contains(Events::TIME_JUMP));
    }
    // Idle, nothing depends on the order: any number but the same is a new start, without an interval.
    let mut arm = Arm::<1>::with(FIRST, JointOptions::default(), &options);
    arm.step(&at(0.0, 0.0, 0.0));
    let told = spoilt(&mut arm, |seen| seen.stamp.sequence = 1_000_000);
    assert!(told.misses == 0 && told.events.contains(Events::TIME_JUMP), "{told:?}");
    let told = spoilt(&mut arm, |seen| seen.stamp.sequence = 1_000_000);
    assert!(told.misses == 1 && told.events.contains(Events::DUPLICATE), "{told:?}");
}

#[test]
fn an_interval_is_integrated_in_one_two_or_three_steps_or_not_at_all() {
    // Of the estimator of first order: φ̂ ← φ̂ + α (h (τ − φ̂) − M̄ Δq̇ h/Δt), once per step of h, none
    // longer than 1.5 T.
    let alpha = -(-70.0 * T).exp_m1() / T;
    for (elapsed, steps) in [
        (T_NS / 20 - 1, 0),
        (T_NS / 20, 1),
        (T_NS - 1, 1),
        (T_NS, 1),
        (T_NS * 3 / 2, 1),
        (T_NS * 3 / 2 + 1, 2),
        (T_NS * 2, 2),
        (T_NS * 5 / 2, 2),
        (T_NS * 5 / 2 + 1, 3),
        (T_NS * 3, 3),
        (T_NS * 3 + 1, 0),
    ] {
        let mut arm = tracking(&Options::new(T_NS));
        let before = arm.state.joints[0].phi_hat();
        let last = arm.sense();
        let (tau, change) = (9.0, 0.013);
        let told = spoilt(&mut arm, |seen| {
            seen.stamp.t_ns = seen.stamp.t_ns - T_NS + elapsed;
            seen.now_ns = seen.stamp.t_ns;
            seen.joints[0].tau_applied = tau;
            seen.joints[0].dq = last.joints[0].dq + change;
        });
        let mut want = before;
        for _ in 0..steps {
            let share = 1.0 / f64::from(steps);
            let h = elapsed as f64 * 1e-9 * share;
            // What the joint said at the sample before is where it stood still.
            want += alpha * (h * (tau - want) - (last.joints[0].dq + change) * share);
        }
        let is = arm.state.joints[0].phi_hat();
        assert!((is - want).abs() < 1e-6, "{elapsed} ns: {is} against {want}, from {before}");
        assert!(steps == 0 || (want - before).abs() > 1e-3);
        assert_eq!(told.events.contains(Events::TIME_JUMP), steps == 0, "{elapsed} ns");
        assert_eq!(told.misses, 0);
    }
}

#[test]
fn losses_are_counted_over_64_samples_and_stop_beyond_their_number() {
    // One sample of three is lost: after 62 samples some 21 are.
    for (lost_max, stops) in [(20, true), (21, true), (22, false), (64, false)] {
        let options = Options { lost_max, ..Options::new(T_NS) };
        let mut arm = tracking(&options);
        let (mut fault, mut most) = (None, 0);
        let mut window = std::collections::VecDeque::from([false; 64]);
        for k in 0..300 {
            let lost = k % 3 == 1 && fault.is_none();
            let told = spoilt(&mut arm, |seen| {
                if lost {
                    seen.stamp.sequence -= 1;
                }
            });
            window.push_back(lost);
            window.pop_front();
            let count = window.iter().filter(|lost| **lost).count();
            assert_eq!(told.lost as usize, count, "sample {k}");
            most = most.max(count);
            if told.fault.is_some() && fault.is_none() {
                fault = told.fault;
                assert_eq!(count, lost_max as usize + 1, "one more than allowed");
            }
        }
        assert_eq!(fault, stops.then_some((Fault::LinkQuality, 0)), "{lost_max}: at most {most}");
    }
}

#[test]
fn wrong_times_are_counted_over_64_samples_and_stop_beyond_their_number() {
    // One sample of three comes without any time since the last: after 62 samples some 21 have.
    for (clock_max, stops) in [(0, true), (20, true), (21, true), (22, false), (64, false)] {
        let options = Options { clock_max, ..Options::new(T_NS) };
        let mut arm = tracking(&options);
        let mut fault = None;
        let mut window = std::collections::VecDeque::from([false; 64]);
        for k in 0..300 {
            let wrong = k % 3 == 1 && fault.is_none();
            let told = spoilt(&mut arm, |seen| {
                if wrong {
                    seen.stamp.t_ns -= T_NS;
                }
            });
            assert_eq!(told.events.contains(Events::TIME_JUMP), wrong, "sample {k}");
            assert_eq!(told.misses, 0);
            // What is seen at a sample is counted with it.
            window.push_back(wrong);
            window.pop_front();
            let count = window.iter().filter(|wrong| **wrong).count();
            if told.fault.is_some() && fault.is_none() {
                fault = told.fault;
                assert_eq!(count, clock_max as usize + 1, "one more than allowed");
            }
            assert!(fault.is_some() || count <= clock_max as usize, "sample {k}: {count}");
        }
        assert_eq!(fault, stops.then_some((Fault::Clock, 0)), "{clock_max}");
    }
}
