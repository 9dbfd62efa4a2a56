//! The reference governor. Wrong if any reference leaves its limits, overshoots, does not arrive, or if one that
//! keeps the limits is touched.

use crate::arm::{Arm, Dice, FIRST, SECOND, T, at};
use phihat::{Events, JointOptions, MotionLimits, Reference, Shaper};

fn limits(dice: &mut Dice) -> MotionLimits {
    MotionLimits {
        velocity: dice.within(0.1, 3.0),
        acceleration: dice.within(0.5, 20.0),
        jerk: dice.within(20.0, 5000.0),
    }
}

/// Largest of |v|/V, |a|/A, |Δa|/(JT), |Δv|/(AT) and |Δq|/(VT) over a step.
fn use_of(l: &MotionLimits, before: &Reference<f64>, now: &Reference<f64>) -> f64 {
    let steps = [
        now.dq / l.velocity,
        now.ddq / l.acceleration,
        (now.ddq - before.ddq) / (l.jerk * T),
        (now.dq - before.dq) / (l.acceleration * T),
        (now.q - before.q) / (l.velocity * T),
    ];
    steps.iter().fold(0.0, |most, s| s.abs().max(most))
}

#[test]
fn f21_ten_thousand_random_setpoints_stay_within_limits() {
    let mut dice = Dice(21);
    let (mut most, mut late) = (0.0_f64, 0);
    for _ in 0..50 {
        let l = limits(&mut dice);
        let shaper = Shaper::new(&l, T).unwrap();
        let mut now = Reference::default();
        for _ in 0..200 {
            let scale = 10.0_f64.powf(dice.within(-4.0, 0.5));
            let target = Reference {
                q: dice.within(-1.0, 1.0) * scale,
                // Also setpoints that make no sense: a velocity at rest.
                dq: if dice.bits().is_multiple_of(4) { dice.within(-5.0, 5.0) } else { 0.0 },
                ddq: if dice.bits().is_multiple_of(8) { dice.within(-50.0, 50.0) } else { 0.0 },
            };
            for _ in 0..dice.bits() % 400 {
                let next = shaper.step(&now, &target);
                most = most.max(use_of(&l, &now, &next));
                assert!(next.q.is_finite());
                now = next;
            }
        }
        // Then it arrives, and stays.
        let target = Reference { q: 0.7, dq: 0.0, ddq: 0.0 };
        let travel = (now.q - target.q).abs();
        let time = travel / l.velocity
            + 8.0 * (l.velocity / l.acceleration + l.acceleration / l.jerk)
            + 8.0 * (travel / l.acceleration).sqrt()
            + 2.0;
        let begin = std::iter::successors(Some(0.0), |t| Some(t + T));
        for _ in begin.take_while(|t| *t < time) {
            let next = shaper.step(&now, &target);
            most = most.max(use_of(&l, &now, &next));
            now = next;
        }
        late += u32::from((now.q - 0.7).abs() > 1e-6 || now.dq.abs() > 1e-5);
    }
    println!("F21: largest use of a limit {most:.12}, late {late} of 50");
    assert!(most <= 1.0 + 1e-9, "{most}");
    assert_eq!(late, 0);
}

#[test]
fn steps_do_not_overshoot() {
    let mut dice = Dice(3);
    let mut worst = 0.0_f64;
    for _ in 0..300 {
        let l = limits(&mut dice);
        let shaper = Shaper::new(&l, T).unwrap();
        let target = Reference { q: 10.0_f64.powf(dice.within(-3.0, 0.5)), dq: 0.0, ddq: 0.0 };
        let mut now = Reference::default();
        for _ in 0..40_000 {
            now = shaper.step(&now, &target);
            worst = worst.max((now.q - target.q) / target.q);
        }
        assert!((now.q - target.q).abs() < 1e-6 * target.q.max(1.0), "{l:?} {target:?} {now:?}");
    }
    println!("largest overshoot of a step {worst:.2e} of it");
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn a_smooth_reference_passes_bit_for_bit() {
    let l = MotionLimits { velocity: 1.0, acceleration: 5.0, jerk: 50.0 };
    let shaper = Shaper::new(&l, T).unwrap();
    let wave = |k: u64| {
        let (t, w, a) = (k as f64 * T, 3.0, 0.3);
        // A start at rest: the amplitude grows over a second.
        Reference {
            q: a * (1.0 - (w * t).cos()),
            dq: a * w * (w * t).sin(),
            ddq: a * w * w * (w * t).cos(),
        }
    };
    let mut now = wave(0);
    for k in 1..20_000 {
        now = shaper.step(&now, &wave(k));
        assert_eq!(now, wave(k), "sample {k}");
    }
}

/// Largest torque-limit and rate-limit use while a jump of the reference is followed.
fn jump_use(a: &[f64], inertia: f64, jump: f64, shaped: bool) -> (bool, f64) {
    let joint = JointOptions {
        motion: shaped.then(|| MotionLimits::within_torque(2.0, 87.0, 1000.0, 1.5, 0.4)),
        ..JointOptions::default()
    };
    let options =
        phihat::Options { start_mismatch_max: 10.0, ..phihat::Options::new(crate::arm::T_NS) };
    let mut arm = Arm::<1>::with(a, joint, &options);
    arm.truth[0].inertia = inertia;
    arm.start();
    let mut limited = false;
    for _ in 0..6000 {
        let answer = arm.step(&at(jump, 0.0, 0.0));
        let acted = Events::SATURATED | Events::RATE_LIMITED;
        limited |= answer.report.events.bits() & acted.bits() != 0;
        if arm.truth[0].q.abs() > 100.0 {
            break;
        }
    }
    (limited, (arm.truth[0].q - jump).abs())
}

#[test]
fn f02_with_the_governor_no_jump_meets_a_torque_or_rate_limit() {
    let mut lost = 0;
    for a in [FIRST, SECOND] {
        for inertia in [0.5, 1.0, 1.5] {
            for jump in [0.01, 0.1, 0.5, 1.0, 3.1] {
                let (limited, left) = jump_use(a, inertia, jump, true);
                assert!(!limited, "m = {} J = {inertia} jump {jump}: a limit acted", a.len());
                assert!(left < 1e-6, "m = {} J = {inertia} jump {jump}: left {left}", a.len());
            }
        }
    }
    let design = |j| jump_use(SECOND, 1.0, j, false);
    for jump in [1.0, 3.1] {
        lost += u32::from(design(jump).0);
    }
    assert_eq!(lost, 2, "without the governor the limits act, so this test can fail");
}
