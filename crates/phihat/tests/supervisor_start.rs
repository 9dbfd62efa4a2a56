//! Starting, stopping and starting again. Wrong if torque or pose jump, or if anything moves by itself.

use crate::arm::{Arm, Dice, FIRST, SECOND, at};
use phihat::{JointOptions, Mode, ModeRequest, Reference, Refusal};

#[test]
fn a_start_under_load_with_a_preset_moves_nothing() {
    for a in [FIRST, SECOND] {
        let mut arm = Arm::<2>::new(a, JointOptions::default());
        for (joint, load) in arm.truth.iter_mut().zip([40.0, -25.0]) {
            joint.load = load;
            joint.q = 0.4;
        }
        arm.start();
        assert_eq!(arm.state.arm.mode(), Mode::Tracking);
        for _ in 0..500 {
            arm.step(&at(0.4, 0.0, 0.0));
        }
        for joint in &arm.truth {
            assert!((joint.q - 0.4).abs() < 1e-9, "{a:?}: {joint:?}");
        }
    }
}

#[test]
fn f21_a_reference_far_from_the_pose_does_not_start() {
    // On either side, in either joint; within 0.05 rad it starts.
    for (far, starts) in [
        ([0.051, 0.0], false),
        ([-0.051, 0.0], false),
        ([0.0, 0.051], false),
        ([0.0, -0.051], false),
        ([-3.0, 3.0], false),
        ([0.049, -0.049], true),
    ] {
        let mut arm = Arm::<2>::new(SECOND, JointOptions::default());
        let asked = far.map(|q| Reference { q, dq: 0.0, ddq: 0.0 });
        for mode in [ModeRequest::Arm, ModeRequest::Hold, ModeRequest::Track] {
            arm.mode = mode;
            let told = arm.step(&asked).report;
            if mode == ModeRequest::Track {
                assert_eq!(told.refusal, (!starts).then_some(Refusal::StartMismatch), "{far:?}");
                assert_eq!(told.mode, if starts { Mode::Tracking } else { Mode::Holding });
            }
        }
        for _ in 0..1000 {
            arm.step(&asked);
        }
        for (joint, far) in arm.truth.iter().zip(far) {
            let want = if starts { far } else { 0.0 };
            assert!((joint.q - want).abs() < 1e-6, "an arm that holds does not move: {joint:?}");
        }
    }
}

#[test]
fn an_arm_that_moves_is_not_armed() {
    for (dq, rests) in [(0.05, true), (-0.05, true), (0.051, false), (-0.051, false)] {
        for moving in 0..2 {
            let mut arm = Arm::<2>::new(SECOND, JointOptions::default());
            arm.step(&at(0.0, 0.0, 0.0));
            arm.mode = ModeRequest::Arm;
            let mut seen = arm.sense();
            seen.joints[moving].dq = dq;
            let told = arm.step_with(&seen, &at(0.0, 0.0, 0.0)).report;
            assert_eq!(told.mode, if rests { Mode::Armed } else { Mode::Idle }, "{dq}");
            assert_eq!(told.refusal, (!rests).then_some(Refusal::NotAtRest), "{dq}");
        }
    }
}

/// Stops at a random phase of a motion under load, waits, arms again at the reference's place.
fn stop_and_restart(dice: &mut Dice) -> (f64, f64) {
    let mut arm = Arm::<1>::new(SECOND, JointOptions::default());
    arm.truth[0].load = dice.within(-40.0, 40.0);
    arm.start();
    let wave = |t: f64| {
        let (amplitude, w) = (0.3, 2.0);
        let (s, c) = (w * t).sin_cos();
        at::<1>(amplitude * (1.0 - c), amplitude * w * s, amplitude * w * w * c)
    };
    let begin = arm.time();
    let stop_at = 700 + dice.bits() % 3000;
    for _ in 0..stop_at {
        let r = wave(arm.time() - begin);
        arm.step(&r);
    }
    arm.mode = ModeRequest::Stop;
    for _ in 0..1000 {
        arm.step(&wave(0.3));
    }
    let pose = arm.truth[0].q;
    // Released: the caller goes on asking for what it wanted, and nothing moves.
    arm.mode = ModeRequest::Track;
    for _ in 0..200 {
        let answer = arm.step(&wave(1.0));
        assert_eq!(answer.report.refusal, Some(Refusal::Latched));
    }
    assert!((arm.truth[0].q - pose).abs() < 5e-3, "moved without a call");
    let (mut speed, mut jump) = (0.0_f64, 0.0_f64);
    let mut last = arm.truth[0].tau;
    let target = arm.truth[0].q + dice.within(-0.045, 0.045);
    for k in 0..700 {
        arm.mode = match k {
            0 => ModeRequest::Arm,
            1 => ModeRequest::Hold,
            _ => ModeRequest::Track,
        };
        let answer = arm.step(&at(target, 0.0, 0.0));
        jump = jump.max((answer.commands[0].tau - last).abs());
        last = answer.commands[0].tau;
        speed = speed.max(arm.truth[0].dq.abs());
    }
    assert_eq!(arm.state.arm.mode(), Mode::Tracking);
    assert!((arm.truth[0].q - target).abs() < 1e-3, "{:?} {target}", arm.truth);
    (speed, jump)
}

#[test]
fn f15_a_thousand_stops_and_restarts() {
    let mut dice = Dice(15);
    let (mut speed, mut jump) = (0.0_f64, 0.0_f64);
    for _ in 0..1000 {
        let (s, j) = stop_and_restart(&mut dice);
        (speed, jump) = (speed.max(s), jump.max(j));
    }
    println!("F15: speed after restart {speed:.3} rad/s, torque step {jump:.3} N·m");
    assert!(jump <= 1.0 + 1e-9, "1000 N·m/s for 1 ms: {jump}");
    assert!(speed <= 0.25, "{speed} rad/s");
}
