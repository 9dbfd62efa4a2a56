//! Trust of a stopped arm in samples after a gap, in sensors that failed and are sound again, and in an
//! earlier holding torque. Wrong if it answers a sample that shows nothing yet, if it goes on without sensors
//! that it has or with ones that it has not, or if it holds a torque estimated from the cause of the stop.
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]

use crate::arm::{Arm, FIRST, Seen};
use crate::joint::{INERTIA, Joint, T, T_NS, gains, outer};
use phihat::{
    Answer, Events, Fault, JointOptions, Measurement, Mode, ModeRequest, Options, Reference,
};

const KP: f64 = 400.0;
const KD: f64 = 40.0;
const LOAD: f64 = 5.0;
/// Half of `K_d` damps in a stop.
const DAMPING: f64 = 0.5 * KD * INERTIA;

fn plausible() -> JointOptions<f64> {
    JointOptions {
        velocity_max: Some(3.0),
        error_stop: Some(0.05),
        frozen_travel: Some(1e-3),
        ..JointOptions::default()
    }
}

/// A joint that has long stood under a load that it knows.
fn standing(options: &Options) -> (Joint, Measurement<f64>) {
    let mut joint = Joint::new(gains(KP, KD, FIRST), plausible(), options);
    let m = Measurement { q: 0.3, dq: 0.0, tau_applied: LOAD };
    for _ in 0..2000 {
        joint.hold(m, Reference { q: 0.3, ..Reference::default() });
    }
    (joint, m)
}

fn stop(joint: &mut Joint, m: Measurement<f64>) -> Answer<f64, 1> {
    let answer = joint.step(ModeRequest::Stop, m, Reference::default());
    assert_eq!(answer.report.mode, Mode::SafeStop);
    answer
}

fn missed(joint: &mut Joint) -> Answer<f64, 1> {
    joint.miss(ModeRequest::Stop, Reference::default())
}

/// A sample later, at a speed.
fn gone(m: Measurement<f64>, speed: f64) -> Measurement<f64> {
    Measurement { q: m.q + T * speed, dq: speed, ..m }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

#[test]
fn the_brakes_of_a_moving_arm_whose_link_is_lost_are_asked_for_once_the_torque_is_not_held_any_more()
 {
    for hold_samples in [0, 5, 9] {
        let (mut joint, mut m) = standing(&Options { hold_samples, ..Options::new(T_NS) });
        for _ in 0..20 {
            m = gone(m, 0.15);
            assert!(!stop(&mut joint, m).report.brake, "it moves");
        }
        for k in 1..40 {
            assert_eq!(missed(&mut joint).report.brake, k > hold_samples, "{k} of {hold_samples}");
        }
    }
}

#[test]
fn after_a_gap_the_law_waits_until_the_velocity_is_how_the_joint_goes() {
    // Told by a torque that is held, and not answered anew. Off by so much [rad/s] is another motion, and off
    // by 0.5 rad/s is not yet.
    for (off, waits) in [(0.0, 1), (0.49, 1), (-0.49, 1), (0.51, 100), (-0.51, 100), (2.0, 100)] {
        for missing in [1, 4] {
            let (mut joint, m) = standing(&Options::new(T_NS));
            for _ in 0..20 {
                assert!(!stop(&mut joint, m).commands[0].status.refused);
            }
            for _ in 0..missing {
                assert!(missed(&mut joint).commands[0].status.refused);
            }
            let m = Measurement { dq: off, ..m };
            let waited = (0..300).take_while(|_| stop(&mut joint, m).commands[0].status.refused);
            assert_eq!(waited.count(), waits, "off by {off} after {missing} missed");
        }
    }
    // As soon as it goes as it says.
    let (mut joint, m) = standing(&Options::new(T_NS));
    stop(&mut joint, m);
    missed(&mut joint);
    let waited = (0..300).take_while(|k| {
        let m = Measurement { dq: if *k < 30 { 1.0 } else { 0.0 }, ..m };
        stop(&mut joint, m).commands[0].status.refused
    });
    assert_eq!(waited.count(), 31);
    // Where the arm does not stop, nothing waits.
    let (mut joint, m) = standing(&Options::new(T_NS));
    joint.miss(ModeRequest::Hold, Reference::default());
    let answer = joint.step(ModeRequest::Hold, Measurement { dq: 1.0, ..m }, Reference::default());
    assert!(!answer.commands[0].status.refused);
}

#[test]
fn a_stop_begins_anew_where_a_position_could_not_be_believed_and_goes_on_where_none_came() {
    for came in [true, false] {
        let (mut joint, mut m) = standing(&Options::new(T_NS));
        for _ in 0..300 {
            stop(&mut joint, m);
        }
        let home = joint.state.joints[0].reference().q;
        m.q += 0.2;
        if came {
            let answer = stop(&mut joint, m);
            assert!(answer.report.events.contains(Events::IMPLAUSIBLE));
        } else {
            missed(&mut joint);
        }
        for _ in 0..3 {
            assert!(!stop(&mut joint, m).report.events.contains(Events::IMPLAUSIBLE));
        }
        let at = joint.state.joints[0].reference().q;
        assert!(close(at, if came { m.q } else { home }), "{came}: {at}, not {home} nor {}", m.q);
    }
}

/// Samples that are refused until the arm stops for that.
fn blinded(joint: &mut Joint, bad: Measurement<f64>) -> Answer<f64, 1> {
    let mut last = None;
    for _ in 0..5 {
        last = Some(joint.step(ModeRequest::Hold, bad, Reference::default()));
    }
    let answer = last.unwrap();
    assert_eq!(answer.report.fault, Some((Fault::BadSample, 0)));
    answer
}

/// After its sensors failed: the torque that held the joint, and damping, for a hundred sound samples; then
/// what is expected.
#[test]
fn sensors_that_are_sound_for_a_hundred_samples_are_believed_again() {
    for jumped in [false, true] {
        let (mut joint, mut m) = standing(&Options::new(T_NS));
        let bad = if jumped {
            Measurement { q: m.q + 1.0, ..m }
        } else {
            Measurement { q: f64::NAN, ..m }
        };
        blinded(&mut joint, bad);
        if jumped {
            // It stays there.
            m.q += 1.0;
        }
        // This one comes after a gap.
        m = gone(m, 0.1);
        assert!(stop(&mut joint, m).commands[0].status.refused);
        // The law is not asked: what acts is the torque of before, and damping.
        for k in 2..100 {
            m = gone(m, 0.1);
            let command = stop(&mut joint, m).commands[0];
            assert!(close(command.phi_hat, LOAD), "{k}: {command:?}");
            assert!(close(command.tau, LOAD - 0.1 * DAMPING), "{k}: {command:?}");
        }
        for k in 100..130 {
            m = gone(m, 0.1);
            let command = stop(&mut joint, m).commands[0];
            if jumped {
                // It may be off for good, or be another joint's: nothing acts from a position.
                assert!(close(command.phi_hat, LOAD), "{k}: {command:?}");
                assert!(close(command.tau, LOAD - 0.1 * DAMPING), "{k}: {command:?}");
            } else {
                // The stop goes on from where the joint is and how it goes.
                let at = joint.state.joints[0].reference();
                assert!(k > 100 || (at.q - m.q).abs() < 1e-4, "{k}: {at:?} {m:?}");
                assert!(k > 100 || (at.dq - 0.1).abs() < 0.05, "{k}: {at:?}");
                assert!(close(command.tau, outer(KP, KD, &m, at) + command.phi_hat), "{k}");
            }
        }
    }
}

/// Sample that follows another one.
type Next = fn(Measurement<f64>) -> Measurement<f64>;

#[test]
fn a_sample_that_is_not_sound_begins_the_count_anew() {
    // Each in the midst of sound ones; whether it is one of them.
    let moving = |m: Measurement<f64>| gone(m, 0.1);
    let unlike = |m: Measurement<f64>| Measurement { dq: 0.7, ..gone(m, 0.1) };
    let like = |m: Measurement<f64>| Measurement { dq: 0.5, ..gone(m, 0.1) };
    let stuck = |m: Measurement<f64>| Measurement { dq: 0.03, ..m };
    let stands = |m: Measurement<f64>| Measurement { dq: 0.019, ..m };
    let backward = |m: Measurement<f64>| gone(m, -0.1);
    let all: [(&str, Next, bool); 6] = [
        ("as before", moving, true),
        ("another velocity", unlike, false),
        ("much the same velocity", like, true),
        ("a position that stands, a velocity that does not", stuck, false),
        ("a joint that stands", stands, true),
        ("the other way", backward, true),
    ];
    for (name, next, sound) in all {
        let (mut joint, mut m) = standing(&Options::new(T_NS));
        blinded(&mut joint, Measurement { q: f64::NAN, ..m });
        stop(&mut joint, m);
        for k in 2.. {
            m = if k == 60 { next(m) } else { moving(m) };
            let was = joint.state.joints[0].reference().q;
            stop(&mut joint, m);
            // The law goes on: there is a reference again.
            if (joint.state.joints[0].reference().q - was).abs() > 0.0 {
                assert_eq!(k, if sound { 100 } else { 160 }, "{name}");
                break;
            }
            assert!(k < 400, "{name}: never");
        }
    }
    // A sample that is missed is not sound, either.
    let (mut joint, mut m) = standing(&Options::new(T_NS));
    blinded(&mut joint, Measurement { q: f64::NAN, ..m });
    let mut found = None;
    for k in 1..400 {
        m = moving(m);
        let was = joint.state.joints[0].reference().q;
        if k == 60 {
            missed(&mut joint)
        } else {
            stop(&mut joint, m)
        };
        if (joint.state.joints[0].reference().q - was).abs() > 0.0 {
            found = found.or(Some(k));
        }
    }
    assert_eq!(found, Some(160));
}

#[test]
fn closed_brakes_take_over_from_the_law_with_the_torque_that_held_the_arm_until_then() {
    for takes in [20, 100] {
        let options = Options { brake_s: Some(f64::from(takes) * T), ..Options::new(T_NS) };
        let (mut joint, mut m) = standing(&options);
        // It is pushed, and stands all the same: what holds it is learnt.
        m.tau_applied = LOAD + 1.0;
        let mut mean = LOAD;
        for k in 0..3 * takes {
            let answer = stop(&mut joint, m);
            assert!(answer.report.brake, "it rests from the first sample on");
            let command = answer.commands[0];
            if k <= takes {
                let law = outer(KP, KD, &m, joint.state.joints[0].reference()) + command.phi_hat;
                assert!(
                    close(command.tau, law) && command.phi_hat > LOAD + 0.01,
                    "{k}: {command:?}"
                );
                mean += T / 0.05 * (command.phi_hat - mean);
            } else {
                assert!(
                    close(command.phi_hat, mean) && close(command.tau, mean),
                    "{k}: {command:?}"
                );
            }
        }
        assert!(mean > LOAD + 0.1);
    }
}

/// Age of the torque that a stopped arm holds \[samples\]: of a joint whose load grows, stopped after so many
/// samples by a fault that `φ̂` does not contain, or by one that it does.
fn age(after: u32, learnt: bool) -> u32 {
    let (mut joint, mut m) = standing(&Options::new(T_NS));
    let mut mean = LOAD;
    let mut means = vec![mean];
    let at = Reference { q: m.q, ..Reference::default() };
    for k in 0..after + 30 {
        if k >= after {
            if !learnt {
                break;
            }
            // A push takes it off its pose.
            m.q += 0.004;
        }
        m.tau_applied += 1e-3;
        let answer = joint.step(ModeRequest::Hold, m, at);
        if answer.report.mode == Mode::SafeStop {
            break;
        }
        mean += T / 0.05 * (answer.commands[0].phi_hat - mean);
        means.push(mean);
    }
    let mut held = 0.0;
    for _ in 0..30 {
        let answer = joint.miss(ModeRequest::Hold, at);
        held = answer.commands[0].phi_hat;
        if answer.report.mode == Mode::SafeStop {
            let fault = if learnt { Fault::TrackingError } else { Fault::LinkLost };
            assert_eq!(answer.report.fault, Some((fault, 0)));
        }
    }
    assert_eq!(joint.state.arm.mode(), Mode::SafeStop);
    let known = means.iter().rposition(|mean| (mean - held).abs() < 1e-9);
    u32::try_from(means.len() - 1 - known.unwrap()).unwrap()
}

#[test]
fn what_holds_a_stopped_arm_is_from_before_what_stopped_it() {
    // A link that is lost has taught nothing: what was known at the last sample holds the arm.
    assert_eq!([700, 813].map(|after| age(after, false)), [0, 0]);
    // φ̂ may have followed a push for a quarter of a second, and has not for two; which of both depends on
    // when it comes.
    let ages: Vec<u32> = (700..1200).step_by(10).map(|after| age(after, true)).collect();
    println!("{ages:?}");
    assert!(ages.iter().all(|age| (250..=500).contains(age)), "{ages:?}");
    assert!(ages.iter().any(|age| *age < 260) && ages.iter().any(|age| *age > 490), "{ages:?}");
    assert_eq!(ages[..25], ages[25..], "every quarter of a second");
}

/// A drive that turns round in a stop: whether its joint is let go depends on whether a velocity can be believed.
#[test]
fn a_drive_is_let_go_by_velocities_that_are_believed_and_by_no_others() {
    for shaken in [true, false] {
        let options = JointOptions {
            oscillation: Some(1.0),
            first_motion: Some(0.5),
            ..JointOptions::default()
        };
        let mut joint = Joint::new(gains(KP, KD, FIRST), options, &Options::new(T_NS));
        let mut m = Measurement { q: 0.3, dq: 0.0, tau_applied: LOAD };
        for _ in 0..2000 {
            joint.hold(m, Reference { q: 0.3, ..Reference::default() });
        }
        for k in 0..100 {
            // Either it is the law that may shake the arm, or samples cannot be believed.
            let off = if k % 2 == 0 { 2e-3 } else { 0.0 };
            let seen = if shaken { m.q + off } else { f64::NAN };
            stop(&mut joint, Measurement { q: if k < 20 { m.q } else { seen }, ..m });
        }
        let told = stop(&mut joint, m).report;
        let fault = if shaken { Fault::Oscillation } else { Fault::BadSample };
        assert_eq!(told.fault, Some((fault, 0)));
        let mut gone = None;
        for k in 0..90 {
            let tau = joint.state.joints[0].tau();
            m.dq += if k < 40 { 0.02 } else { -T / INERTIA * (tau - LOAD) };
            m = Measurement { q: m.q + T * m.dq, tau_applied: tau, ..m };
            let answer = stop(&mut joint, m);
            if gone.is_some() {
                assert!(answer.commands[0].tau.abs() < 1e-12, "{k}: {answer:?}");
            } else if answer.report.events.contains(Events::LET_GO) {
                gone = Some(k);
            }
        }
        assert!(gone.is_some() == shaken && m.dq > 0.5, "{shaken}: {gone:?} {m:?}");
    }
}

/// Positions \[rad\] at which three joints stand, and velocities \[rad/s\] of joints that are taken for them.
const AT: [f64; 3] = [0.3, -0.5, 1.0];
const WRONG: [f64; 3] = [0.4, -0.2, 0.3];

/// An arm of three joints that has been stopped for 300 samples and stands under its load.
fn stopped_arm() -> Arm<3> {
    let mut arm = Arm::<3>::new(FIRST, plausible());
    for (joint, q) in arm.truth.iter_mut().zip(AT) {
        (joint.q, joint.load) = (q, LOAD);
    }
    arm.start();
    arm.mode = ModeRequest::Stop;
    for _ in 0..300 {
        arm.step(&[Reference::default(); 3]);
    }
    assert_eq!(arm.state.arm.mode(), Mode::SafeStop);
    arm
}

/// The k-th sample in which the joints stand in another order, and those that are not in their places move.
fn reordered(arm: &Arm<3>, order: [usize; 3], k: u32) -> Seen<3> {
    let mut sample = arm.sense();
    sample.joints = core::array::from_fn(|i| {
        let dq = if order[i] == i { 0.0 } else { WRONG[i] };
        Measurement { q: AT[order[i]] + dq * T * f64::from(k), dq, tau_applied: LOAD }
    });
    sample
}

#[test]
fn positions_of_several_joints_that_jump_at_once_bring_no_damper() {
    let none = [Reference::default(); 3];
    // Two joints and all three, exchanged for good: no sample counts for 100 of them, and then none of them damps.
    for order in [[1, 0, 2], [1, 2, 0]] {
        let mut arm = stopped_arm();
        for k in 0..400 {
            let sample = reordered(&arm, order, k);
            let answer = arm.step_with(&sample, &none);
            let refused = answer.report.events.contains(Events::IMPLAUSIBLE);
            assert_eq!(refused, k <= 100, "{order:?} at {k}");
            for (i, command) in answer.commands.iter().enumerate() {
                // The rate limit lets the last damping out in a few samples.
                assert!(k < 10 || close(command.tau, command.phi_hat), "{i} at {k}: {command:?}");
                assert!((-1e-6..=LOAD + 0.1).contains(&command.tau), "{i} at {k}: {command:?}");
            }
        }
    }
    // Positions that come back are the arm's again, and the law goes on from them.
    let mut arm = stopped_arm();
    for k in 0..50 {
        let sample = reordered(&arm, [1, 2, 0], k);
        arm.step_with(&sample, &none);
    }
    let back = reordered(&arm, [0, 1, 2], 0);
    assert!(!arm.step_with(&back, &none).report.events.contains(Events::IMPLAUSIBLE));
    for _ in 0..100 {
        let sample = reordered(&arm, [0, 1, 2], 0);
        arm.step_with(&sample, &none);
    }
    for (joint, q) in arm.state.joints.iter().zip(AT) {
        assert!((joint.reference().q - q).abs() < 1e-3);
    }
}
