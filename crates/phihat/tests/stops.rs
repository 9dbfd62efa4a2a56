//! Behaviour of a stopped arm, and the request for its brakes. Wrong if torque stays where a drive does not
//! follow its command, if a moving arm loses its torque, or if the brakes are late.
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]

use crate::arm::{Arm, FIRST, SECOND, T, T_NS, at};
use crate::joint::{INERTIA, Joint, gains};
use phihat::{
    Answer, Command, Events, Fault, JointDesign, JointGains, JointOptions, Limits, Measurement,
    Mode, ModeRequest, MotionLimits, Options, Reference, Schedule,
};

const LOAD: f64 = 12.0;
/// Half of K_d times the inertia: what damps in a stop.
const DAMPING: f64 = 20.0;

/// An arm that tracks at rest under a load it knows.
fn tracking<const N: usize>(joint: JointOptions<f64>, options: &Options) -> Arm<N> {
    let mut arm = Arm::<N>::with(SECOND, joint, options);
    for joint in &mut arm.truth {
        joint.load = LOAD;
    }
    arm.start();
    for _ in 0..100 {
        arm.step(&at(0.0, 0.0, 0.0));
    }
    arm
}

/// A sample in which joints move as they are told here, whatever the torque.
fn dragged<const N: usize>(arm: &mut Arm<N>, dq: [f64; N]) -> Answer<f64, N> {
    for (joint, dq) in arm.truth.iter_mut().zip(dq) {
        joint.dq = dq;
    }
    arm.step(&at(0.0, 0.0, 0.0))
}

#[test]
fn brakes_are_asked_for_in_idle_and_in_no_running_mode() {
    let mut arm = Arm::<1>::new(SECOND, JointOptions::default());
    for (mode, reached, brake) in [
        (ModeRequest::Idle, Mode::Idle, true),
        (ModeRequest::Arm, Mode::Armed, false),
        (ModeRequest::Idle, Mode::Idle, true),
        (ModeRequest::Arm, Mode::Armed, false),
        (ModeRequest::Hold, Mode::Holding, false),
        (ModeRequest::Track, Mode::Tracking, false),
        (ModeRequest::Stop, Mode::SafeStop, true),
        (ModeRequest::Arm, Mode::Armed, false),
    ] {
        for _ in 0..3 {
            arm.mode = mode;
            let told = arm.step(&at(0.0, 0.0, 0.0)).report;
            assert_eq!((told.mode, told.brake, told.refusal), (reached, brake, None), "{mode:?}");
        }
    }
}

#[test]
fn the_brakes_of_a_moving_arm_wait_until_every_joint_rests_and_stay() {
    for moving in 0..2 {
        let mut arm = tracking::<2>(JointOptions::default(), &Options::new(T_NS));
        arm.mode = ModeRequest::Stop;
        for k in 0..400 {
            // Down to rest, which is 0.05 rad/s, and through it to the other side: once asked for, brakes stay closed.
            let speed = 0.45 - 0.0025 * f64::from(k);
            let mut dq = [0.0; 2];
            dq[moving] = speed;
            let told = dragged(&mut arm, dq).report;
            assert_eq!(told.mode, Mode::SafeStop);
            if (speed.abs() - 0.05).abs() > 1e-9 {
                assert_eq!(told.brake, speed < 0.05, "joint {moving} at {speed} rad/s");
            }
        }
    }
}

#[test]
fn the_brakes_of_an_arm_that_goes_on_moving_are_asked_for_after_the_stop_time() {
    for (stop_s, samples) in [(0.1, 100), (0.5, 500)] {
        let options = Options { stop_s, ..Options::new(T_NS) };
        let mut arm = tracking::<1>(JointOptions::default(), &options);
        arm.mode = ModeRequest::Stop;
        let first = (0..1000).position(|_| dragged(&mut arm, [0.15]).report.brake);
        assert_eq!(first, Some(samples), "samples after the stop");
    }
}

#[test]
fn without_a_measurement_a_stopped_arm_is_braked_at_once_and_its_torque_fades() {
    let mut arm = tracking::<1>(JointOptions::default(), &Options::new(T_NS));
    let (mut stopped, mut samples) = (None, Vec::new());
    for k in 0..1400 {
        let mut seen = arm.sense();
        seen.stamp.sequence = 1;
        let answer = arm.step_with(&seen, &at(0.0, 0.0, 0.0));
        if answer.report.mode == Mode::SafeStop {
            stopped = stopped.or(Some(k));
            assert!(answer.report.brake);
            samples.push(answer.commands[0].tau);
        } else {
            assert!(!answer.report.brake);
        }
    }
    assert_eq!(stopped, Some(19), "the twentieth");
    // Held for 0.5 s, gone 0.5 s later, in a line.
    for (k, tau) in samples.iter().enumerate() {
        let gone = (k as f64 - 500.0) / 500.0;
        let want = LOAD * (1.0 - gone.clamp(0.0, 1.0));
        // A few samples late.
        assert!((tau - want).abs() < 0.15, "{k} samples after the stop: {tau} against {want}");
    }
    // With a measurement it is held: no fading, however long.
    let mut arm = tracking::<1>(JointOptions::default(), &Options::new(T_NS));
    arm.mode = ModeRequest::Stop;
    let last = (0..2000).map(|_| dragged(&mut arm, [0.0]).commands[0].tau).last().unwrap();
    assert!((last - LOAD).abs() < 1e-6, "{last}");
}

#[test]
fn an_armed_arm_is_held_by_a_spring_and_damped() {
    for (stop_damping, per_speed) in [(0.5, DAMPING), (0.0, 0.0), (1.0, 2.0 * DAMPING)] {
        let options = Options { stop_damping, ..Options::new(T_NS) };
        let mut arm = Arm::<1>::with(SECOND, JointOptions::default(), &options);
        arm.truth[0].load = LOAD;
        arm.preset = Some([LOAD]);
        arm.mode = ModeRequest::Arm;
        for _ in 0..20 {
            dragged(&mut arm, [0.0]);
        }
        let home = arm.truth[0].q;
        for k in 0..40 {
            let answer = dragged(&mut arm, [0.2]);
            let tau = answer.commands[0].tau;
            // Critically damped about the nominal inertia, which is 1.
            let away = arm.truth[0].q - home - T * arm.truth[0].dq;
            let spring = 0.25 * per_speed * per_speed * away;
            assert!(
                (answer.commands[0].phi_hat - LOAD + spring).abs() < 0.1,
                "{k} {answer:?} {spring}"
            );
            if k > 20 {
                let want = answer.commands[0].phi_hat - per_speed * 0.2;
                assert!((tau - want).abs() < 1e-9, "{tau} against {want}");
            }
        }
        // A velocity that does not change while the position stands is no velocity: it would drive.
        let seen = arm.sense();
        for k in 0..40 {
            let now = arm.sense();
            let still = crate::arm::Seen { stamp: now.stamp, now_ns: now.now_ns, ..seen };
            let answer = arm.step_with(&still, &at(0.0, 0.0, 0.0));
            if k > 20 {
                let command = &answer.commands[0];
                assert!((command.tau - command.phi_hat).abs() < 1e-9, "{command:?}");
            }
        }
    }
}

#[test]
fn a_drive_that_does_not_do_what_it_is_told_loses_its_torque_and_is_braked_at_once() {
    let joint = JointOptions { first_motion: Some(0.5), ..JointOptions::default() };
    let mut arm = Arm::<2>::new(SECOND, joint);
    arm.truth[0].load = LOAD;
    arm.start();
    (arm.truth[1].drive, arm.truth[1].load) = (-1.0, 5.0);
    let mut before = arm.step(&at(0.0, 0.0, 0.0));
    let mut stopped = 0;
    for k in 0..200 {
        let answer = arm.step(&at(0.0, 0.0, 0.0));
        let moving = arm.truth[1].dq.abs() > 0.06;
        if answer.report.mode == Mode::SafeStop {
            assert_eq!(answer.report.fault, Some((Fault::Actuation, 1)));
            assert!(answer.report.brake, "{k}: at once, though it moves");
            assert!(moving || stopped > 0, "this test can fail");
            for (now, before) in answer.commands.iter().zip(&before.commands) {
                // To zero as fast as the rate limit lets it, whatever the speed, in every joint.
                let want = before.tau - before.tau.clamp(-1.0, 1.0);
                assert!((now.tau - want).abs() < 1e-9, "{k}: {} from {}", now.tau, before.tau);
                assert!(now.phi_hat.abs() < 1e-12);
            }
            stopped += 1;
        }
        before = answer;
    }
    assert!(stopped > 100, "{stopped}");
    // Any other stop keeps the arm's torque.
    let joint = JointOptions { error_stop: Some(0.01), ..JointOptions::default() };
    let mut arm = tracking::<1>(joint, &Options::new(T_NS));
    arm.truth[0].q += 0.02;
    for _ in 0..30 {
        let answer = arm.step(&at(0.0, 0.0, 0.0));
        assert_eq!(answer.report.fault, Some((Fault::TrackingError, 0)));
        assert!((answer.commands[0].phi_hat - LOAD).abs() < 0.5, "{:?}", answer.commands);
    }
}

#[test]
fn an_arm_that_shook_is_damped_by_a_quarter_and_held_by_the_mean() {
    let joint = JointOptions { oscillation: Some(3.0), ..JointOptions::default() };
    let mut arm = tracking::<1>(joint, &Options::new(T_NS));
    // A joint far lighter than its window shakes.
    arm.truth[0].inertia = 0.03;
    arm.truth[0].dq += 1e-3;
    let mut swing = 0.0_f64;
    let found = (0..300).any(|_| {
        let answer = arm.step(&at(0.0, 0.0, 0.0));
        swing = swing.max((answer.commands[0].phi_hat - LOAD).abs());
        answer.report.fault == Some((Fault::Oscillation, 0))
    });
    assert!(found && swing > 1.0, "{swing}");
    for k in 0..100 {
        let answer = dragged(&mut arm, [0.2]);
        let command = &answer.commands[0];
        assert!((command.phi_hat - LOAD).abs() < 0.3 * swing, "the mean: {command:?}");
        if k > 30 {
            let want = command.phi_hat - 0.25 * DAMPING * 0.2;
            assert!((command.tau - want).abs() < 1e-9, "{command:?} against {want}");
        }
    }
}

#[test]
fn while_samples_are_missed_the_torque_is_held_then_falls_to_the_estimate() {
    let mut arm = tracking::<1>(JointOptions::default(), &Options::new(T_NS));
    // Feedback beside what the load needs.
    arm.truth[0].q += 0.002;
    let last = arm.step(&at(0.0, 0.0, 0.0)).commands[0];
    let feedback = last.tau - last.phi_hat;
    assert!(feedback.abs() > 0.3);
    for missed in 1..20 {
        let mut seen = arm.sense();
        seen.stamp.sequence = 1;
        let command = arm.step_with(&seen, &at(0.0, 0.0, 0.0)).commands[0];
        let want = last.phi_hat + feedback * 0.8_f64.powi((missed - 5).max(0));
        assert!(
            command.status.refused && (command.tau - want).abs() < 1e-9,
            "{missed}: {command:?}"
        );
    }
}

#[test]
fn an_armed_arm_begins_anew() {
    let schedule = Schedule { settled: 1.0, disturbed: f64::INFINITY, dwell_s: 0.05 };
    let joint = JointOptions {
        error_stop: Some(0.01),
        first_motion: Some(0.5),
        start: Some(crate::arm::gains(&[70.0])),
        ..JointOptions::default()
    };
    let options = Options { schedule, ..Options::new(T_NS) };
    let mut arm = Arm::<1>::with(SECOND, joint, &options);
    for start in 0..3 {
        arm.truth[0].drive = 1.0;
        arm.start();
        assert_eq!(arm.step(&at(arm.truth[0].q, 0.0, 0.0)).report.fault, None, "start {start}");
        // The running gains come after the dwell, each time.
        let here = arm.truth[0].q;
        let raised = (0..300)
            .position(|_| arm.step(&at(here, 0.0, 0.0)).report.events.contains(Events::RAISED));
        assert!(raised.is_some_and(|k| k > 30), "start {start}: {raised:?}");
        // The drive is watched again from the start, for a quarter of a second, and it reverses.
        if start == 1 {
            (arm.truth[0].drive, arm.truth[0].load) = (-1.0, 3.0);
        } else {
            arm.truth[0].q += 0.05;
        }
        let told = (0..100).map(|_| arm.step(&at(here, 0.0, 0.0)).report).last().unwrap();
        let fault = if start == 1 { Fault::Actuation } else { Fault::TrackingError };
        assert_eq!((told.mode, told.fault), (Mode::SafeStop, Some((fault, 0))), "start {start}");
        arm.truth[0].load = 0.0;
        arm.truth[0].dq = 0.0;
        // A second fault does not take the place of the first.
        arm.truth[0].q += 0.5;
        assert_eq!(arm.step(&at(here, 0.0, 0.0)).report.fault, Some((fault, 0)));
        arm.mode = ModeRequest::Idle;
        for _ in 0..100 {
            arm.truth[0].dq = 0.0;
            arm.step(&at(here, 0.0, 0.0));
        }
    }
}

/// A quarter of what the limits give the nominal inertia; what the outer loop gives it at 0.2 rad where there
/// are none; and the jerk no faster than that loop.
#[test]
fn a_stop_takes_a_quarter_of_the_limits_or_what_the_outer_loop_gives() {
    let with = |torque: Option<f64>, rate: Option<f64>, inertia: f64| {
        let (kp, kd, period) = (400.0, 40.0, T);
        let design =
            JointDesign { inertia, kp, kd, a: SECOND, period, form: phihat::Form::Observer };
        let limits = Limits::new(torque, rate, T).unwrap();
        JointGains::<f64>::new(&design).unwrap().with_limits(limits)
    };
    for (torque, rate, inertia, acceleration, jerk) in [
        (Some(80.0), Some(1000.0), 2.0, 10.0, 125.0),
        (Some(80.0), None, 2.0, 10.0, 200.0),
        // As fast as K_d/2 lets the acceleration build up.
        (Some(8.0), Some(1000.0), 2.0, 1.0, 20.0),
        (None, Some(1000.0), 2.0, 80.0, 125.0),
        (None, None, 0.5, 80.0, 1600.0),
    ] {
        let gains = with(torque, rate, inertia);
        let is = gains.stop_limits();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * b;
        assert!(near(is.acceleration, acceleration) && near(is.jerk, jerk), "{is:?}");
        // The energy of the nominal inertia at 0.2 rad/s.
        assert!(near(gains.stop_reserve(), 0.02 * inertia), "{}", gains.stop_reserve());
    }
}

/// The feedback of a stop is no more than what the rate limit ρ takes back before a joint of M̄/4 has turned
/// round, and in 10 ms: (Q2).
#[test]
fn a_stop_asks_for_no_torque_that_could_not_be_taken_back_in_time() {
    const RATE: f64 = 300.0;
    let law = gains(400.0, 40.0, FIRST).with_limits(Limits::new(None, Some(RATE), T).unwrap());
    for (speed, armed) in [(0.0_f64, false), (0.4, false), (-0.4, false), (0.9, false), (2.0, true)]
    {
        let mut joint = Joint::new(law, JointOptions::default(), &Options::new(T_NS));
        let mut m = Measurement::default();
        joint.step(ModeRequest::Arm, m, Reference::default());
        let mode = if armed { ModeRequest::Arm } else { ModeRequest::Stop };
        let mut last = None;
        for k in 0..400 {
            // Dragged, and far off where it would rest.
            let off = if k == 5 && !armed { 0.1_f64.copysign(speed) } else { 0.0 };
            m = Measurement { q: m.q + T * speed + off, dq: speed, tau_applied: 0.0 };
            last = Some(joint.step(mode, m, Reference::default()).commands[0]);
        }
        let command = last.unwrap();
        let most = (2.0 * RATE * 0.25 * INERTIA * speed.abs()).sqrt() + RATE * 0.01;
        let want = command.phi_hat - most.copysign(speed);
        assert!((command.tau - want).abs() < 1e-6, "{speed}: {command:?} against {want}");
    }
}

/// A velocity damps as far as the positions bear it out: as it is within twice what they say, else no more
/// than that, and not at all against them.
#[test]
fn what_damps_is_a_velocity_that_positions_bear_out() {
    for (goes, says, counts) in [
        (0.2, 0.2, 0.2),
        (0.2, 0.39, 0.39),
        (0.2, 0.41, 0.2),
        (0.2, 5.0, 0.2),
        (0.2, 0.05, 0.05),
        (0.2, 0.11, 0.11),
        (0.2, -0.1, 0.0),
        (0.2, 0.0, 0.0),
        (0.0, 0.3, 0.0),
        (-0.2, -0.3, -0.3),
        (-0.2, -0.5, -0.2),
        (-0.2, 0.3, 0.0),
        (3.0, 2.0, 2.0),
        (0.6, 1.5, 0.6),
    ] {
        let mut joint =
            Joint::new(gains(400.0, 40.0, FIRST), JointOptions::default(), &Options::new(T_NS));
        let mut m = Measurement::default();
        joint.step(ModeRequest::Arm, m, Reference::default());
        for k in 0..20 {
            m = Measurement { q: m.q + T * goes, dq: says, ..m };
            let Command { tau, phi_hat, .. } =
                joint.step(ModeRequest::Arm, m, Reference::default()).commands[0];
            let want = phi_hat - 0.5 * 40.0 * INERTIA * counts;
            assert!((tau - want).abs() < 1e-9, "{goes} {says}, {k}: {tau} against {want}");
        }
    }
}

/// Gains with lower limits: they hold from the next sample on, and a stop takes its deceleration from them,
/// unless one was stated.
#[test]
fn after_a_change_of_gains_a_lower_torque_limit_holds_and_a_stop_keeps_to_it() {
    let stated = MotionLimits { velocity: 1.0, acceleration: 6.0, jerk: 300.0 };
    for (stop, acceleration) in [(None, 0.25 * 12.0), (Some(stated), 6.0)] {
        let joint = JointOptions { stop, ..JointOptions::default() };
        let mut arm = Arm::<1>::new(SECOND, joint);
        arm.start();
        let limits = Limits::new(Some(12.0), Some(1000.0), T).unwrap();
        let lower = crate::arm::gains(SECOND).with_limits(limits);
        for gains in [crate::arm::gains(FIRST), lower] {
            arm.supervisor.change_gains(&mut arm.state, [gains]).unwrap();
        }
        // Up to a speed; a torque beyond six newton metres of what was commanded is none that the drive can give now.
        let mut told = Vec::new();
        for k in 0..800 {
            let (dq, ddq) = (f64::from(k) * 2e-3, 2.0);
            let mut seen = arm.sense();
            if k == 400 {
                seen.joints[0].tau_applied += 20.0;
            }
            let answer = arm.step_with(&seen, &at(0.5 * f64::from(k) * T * dq, dq, ddq));
            assert_eq!(answer.report.mode, Mode::Tracking);
            if answer.report.events.contains(Events::TORQUE_REFUSED) {
                told.push(k);
            }
        }
        assert_eq!(told, [400]);
        arm.mode = ModeRequest::Stop;
        let (mut before, mut fastest) = (*arm.state.joints[0].reference(), 0.0_f64);
        let mut most = 0.0_f64;
        for k in 0..1500 {
            // A push that asks for more than there is.
            arm.truth[0].load = if k > 700 { 100.0 } else { 0.0 };
            let command = arm.step(&at(0.0, 0.0, 0.0)).commands[0];
            most = most.max(command.tau.abs());
            let now = *arm.state.joints[0].reference();
            if k > 0 && k < 700 {
                fastest = fastest.max((before.dq - now.dq) / T);
            }
            before = now;
        }
        assert!((fastest - acceleration).abs() < 0.02, "{fastest} against {acceleration}");
        assert!((most - 12.0).abs() < 1e-9, "{most}");
    }
}

/// At twice what the positions say a velocity is not borne out any more.
#[test]
fn a_velocity_is_borne_out_below_twice_what_the_positions_say() {
    for (says, counts) in [(0.5, 0.25), (0.499, 0.499), (-0.5, -0.25), (-0.499, -0.499)] {
        let mut joint =
            Joint::new(gains(400.0, 40.0, FIRST), JointOptions::default(), &Options::new(T_NS));
        joint.step(ModeRequest::Arm, Measurement::default(), Reference::default());
        // A quarter, to the last bit.
        let q = 0.25_f64.copysign(says) * T;
        let m = Measurement { q, dq: says, tau_applied: 0.0 };
        let Command { tau, phi_hat, .. } =
            joint.step(ModeRequest::Arm, m, Reference::default()).commands[0];
        let want = phi_hat - 0.5 * 40.0 * INERTIA * counts;
        assert!((tau - want).abs() < 1e-12, "{says}: {tau} against {want}");
    }
}

/// Idle, the torque goes as fast as its rate limit lets it, and nothing is held.
#[test]
fn an_idle_arm_gives_its_torque_up_at_the_rate_limit() {
    let mut arm = Arm::<1>::new(SECOND, JointOptions::default());
    arm.preset = Some([LOAD]);
    arm.mode = ModeRequest::Arm;
    for _ in 0..20 {
        dragged(&mut arm, [0.0]);
    }
    assert!((arm.truth[0].tau - LOAD).abs() < 0.1);
    arm.mode = ModeRequest::Idle;
    for k in 1..20 {
        let before = arm.truth[0].tau;
        let answer = dragged(&mut arm, [0.0]);
        let Command { tau, phi_hat, status } = answer.commands[0];
        assert!((tau - (before - 1.0).max(0.0)).abs() < 1e-12, "{k}: {tau} from {before}");
        assert_eq!(status.rate_limited, before > 1.0);
        assert_eq!(answer.report.events.contains(Events::RATE_LIMITED), before > 1.0);
        assert!(phi_hat.abs() < 1e-12);
    }
    assert!(arm.truth[0].tau.abs() < 1e-12);
}

/// The printed form stops in the observer form: where the joint is kept off its place, nothing winds up.
#[test]
fn a_stop_does_not_wind_up_in_the_printed_form() {
    let design = JointDesign {
        inertia: INERTIA,
        kp: 400.0,
        kd: 40.0,
        a: SECOND,
        period: T,
        form: phihat::Form::Literal,
    };
    let law = JointGains::new(&design).unwrap();
    let mut joint = Joint::new(law, JointOptions::default(), &Options::new(T_NS));
    let mut m = Measurement::default();
    for _ in 0..300 {
        joint.hold(m, Reference::default());
    }
    m.q = 0.05;
    joint.step(ModeRequest::Stop, Measurement::default(), Reference::default());
    for k in 0..500 {
        let answer = joint.step(ModeRequest::Stop, m, Reference::default());
        assert_eq!(answer.report.mode, Mode::SafeStop);
        let Command { tau, phi_hat, .. } = answer.commands[0];
        assert!(phi_hat.abs() < 1e-9, "{k}: {phi_hat}");
        assert!((tau + 400.0 * INERTIA * 0.05).abs() < 1e-6 || k < 5, "{k}: {tau}");
    }
}
