//! Limits and monitors in closed loop. Wrong if a joint winds up, runs into its stop, hunts, shakes or runs
//! away.

use crate::arm::{Arm, Dice, FIRST, SECOND, T, T_NS, at, gains};
use phihat::{
    Events, Fault, Form, Funnel, JointDesign, JointGains, JointOptions, JointRange, Limits, Mode,
    MotionLimits, Options, Reference, Schedule,
};

const THIRD: &[f64] = &[64_000.0, 4800.0, 120.0];

/// Largest overshoot over the step, and the error left, of a bare step under a torque limit.
fn step(a: &[f64], inertia: f64, step: f64, torque: f64, governed: bool) -> (f64, f64) {
    let period = T;
    let design = JointDesign { inertia: 1.0, kp: 400.0, kd: 40.0, a, period, form: Form::Observer };
    let limits = Limits::new(Some(torque), None, T).unwrap();
    let law = JointGains::new(&design).unwrap().with_limits(limits);
    // The torque limit alone: acceleration such that the heaviest joint takes 60 % of it.
    let motion = MotionLimits::within_torque(10.0, torque, 100.0 * torque, inertia.max(1.0), 0.6);
    let joint = JointOptions { motion: governed.then_some(motion), ..JointOptions::default() };
    let options = Options { start_mismatch_max: 10.0, blend_s: 1e-3, ..Options::new(T_NS) };
    let mut arm = Arm::<1>::with(a, joint, &options);
    arm.supervisor = phihat::Supervisor::new([law], &[joint], &options).unwrap();
    arm.truth[0].inertia = inertia;
    arm.start();
    let mut most = 0.0_f64;
    let time = 3.0 + 12.0 * (step / torque).sqrt();
    let begin = arm.time();
    let done = |now: f64| now > begin + time;
    while !done(arm.time()) {
        arm.step(&at(step, 0.0, 0.0));
        most = most.max(arm.truth[0].q - step);
    }
    (most / step, (arm.truth[0].q - step).abs())
}

#[test]
fn f01_steps_at_the_torque_limit_do_not_wind_up() {
    let mut dice = Dice(1);
    let (mut bare, mut governed) = (0.0_f64, 0.0_f64);
    for _ in 0..150 {
        let a = [FIRST, SECOND, THIRD][(dice.bits() % 3) as usize];
        let inertia = dice.within(0.4, 1.6);
        let size = 10.0_f64.powf(dice.within(-2.0, 0.497));
        let torque = 400.0 * size * dice.within(0.1, 1.0);
        let (over, left) = step(a, inertia, size, torque, true);
        assert!(left < 1e-5 * size.max(0.1), "m = {} J {inertia} step {size}: {left}", a.len());
        governed = governed.max(over);
        let (over, left) = step(a, inertia, size, torque, false);
        assert!(left < 1e-3 * size, "no limit cycle: m = {} J {inertia} {size}: {left}", a.len());
        bare = bare.max(over);
    }
    println!(
        "F1: overshoot with the governor {:.1} %, bare {:.1} %",
        100.0 * governed,
        100.0 * bare
    );
    assert!(governed <= 0.2, "{governed}");
}

/// The literal form with three ways out of windup, written down here: none, conditional integration, and
/// back-calculation on the highest integral. Overshoot of a 1 rad step at 87 N·m, 1 kg·m²; infinite: lost.
fn literal_overshoot(a: &[f64], way: &str) -> f64 {
    let (kp, kd, limit) = (400.0, 40.0, 87.0);
    let coefficient = |i: isize| usize::try_from(i).ok().and_then(|i| a.get(i)).map_or(0.0, |x| *x);
    let m = a.len();
    let factor = |i: usize| {
        let i = i.cast_signed();
        coefficient(i - 1) * kp + coefficient(i - 2) * kd + coefficient(i - 3)
    };
    let (mut q, mut dq, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut sums = vec![0.0; m]; // ∫e, ∬e, …
    for _ in 0..4000 {
        let e = q - 1.0;
        let mut next = sums.clone();
        let mut below = e;
        for s in &mut next {
            *s += T * below;
            below = *s;
        }
        let demand = |sums: &[f64]| {
            let mut u = -(kd * dq + kp * e) - factor(m + 1) * e - factor(m + 2) * dq;
            for (j, s) in sums.iter().enumerate() {
                u -= factor(m - j) * s;
            }
            u
        };
        let u = demand(&next);
        let tau = u.clamp(-limit, limit);
        let railed = (u - tau).abs() > 0.0;
        match way {
            "conditional" if railed && u * -e > 0.0 => {}
            "back-calculation" if railed => {
                let highest = m - 1;
                next[highest] += (u - tau) / factor(m - highest);
                sums = next;
            }
            _ => sums = next,
        }
        q += T * dq + 0.5 * T * T * tau;
        dq += T * tau;
        most = most.max(q - 1.0);
        if q.abs() > 1e3 {
            return f64::INFINITY;
        }
    }
    most
}

#[test]
fn f01_the_observer_form_against_other_ways_out_of_windup() {
    for a in [FIRST, SECOND] {
        let ways = ["none", "conditional", "back-calculation"];
        let over = ways.map(|way| literal_overshoot(a, way));
        let (observer, left) = step(a, 1.0, 1.0, 87.0, false);
        println!(
            "F1: m = {}: overshoot {:.2} none, {:.2} conditional, {:.2} back-calculation, {observer:.2} observer form",
            a.len(),
            over[0],
            over[1],
            over[2]
        );
        assert!(left < 1e-6);
        assert!(over[0] > 0.5, "without a way out it winds up");
        assert!(observer <= over[1] + 1e-3 && observer <= over[2] + 1e-3, "{observer} {over:?}");
    }
}

#[test]
fn f09_no_approach_goes_beyond_the_joint_limit() {
    let mut dice = Dice(9);
    let range = JointRange { lower: -1.0, upper: 1.0, soft: 0.05, braking: 8.0 };
    let (mut deepest, mut outward) = (0.0_f64, 0.0_f64);
    for run in 0..1000 {
        let a = if run % 2 == 0 { FIRST } else { SECOND };
        let joint = JointOptions { range: Some(range), ..JointOptions::default() };
        let options = Options { start_mismatch_max: 100.0, ..Options::new(T_NS) };
        let mut arm = Arm::<1>::with(a, joint, &options);
        arm.truth[0].inertia = dice.within(0.6, 1.6);
        arm.truth[0].load = dice.within(-30.0, 30.0);
        arm.truth[0].q = dice.within(-0.9, 0.9);
        arm.start();
        // A reference that runs out of the range, by ramp or by jump.
        let (speed, target) = (dice.within(0.1, 2.5), dice.within(-2.0, 2.0));
        let from = arm.truth[0].q;
        for k in 0..1500 {
            let ramp = from + (target - from).signum() * speed * f64::from(k) * T;
            let (q, dq) =
                if run % 3 == 0 { (target, 0.0) } else { (ramp, speed * (target - from).signum()) };
            let answer = arm.step(&at(q, dq, 0.0));
            let truth = &arm.truth[0];
            deepest = deepest.max(truth.q.abs() - 1.0);
            if truth.q.abs() > 1.0 {
                outward = outward.max(answer.commands[0].tau * truth.q.signum());
            }
        }
    }
    // The same without the range: this test can fail.
    let mut bare = Arm::<1>::new(SECOND, JointOptions::default());
    bare.truth[0].q = 0.9;
    bare.start();
    for _ in 0..1500 {
        bare.step(&at(2.0, 0.0, 0.0));
    }
    assert!(bare.truth[0].q > 1.1);
    println!("F9: deepest {:.3}°, outward torque beyond {outward:.2} N·m", deepest.to_degrees());
    assert!(deepest.to_degrees() <= 0.5, "{}", deepest.to_degrees());
}

#[test]
fn f10_an_oscillation_stops_the_arm_within_50_ms() {
    // A joint far lighter than its window: unstable from the first noise on.
    let joint = JointOptions { oscillation: Some(3.0), ..JointOptions::default() };
    let mut arm = Arm::<1>::new(SECOND, joint);
    arm.truth[0].load = 5.0;
    arm.start();
    let (mut onset, mut found) = (None, None);
    for k in 0..2000 {
        if k == 300 {
            arm.truth[0].inertia = 0.03;
            arm.truth[0].dq += 1e-3;
        }
        let answer = arm.step(&at(0.0, 0.0, 0.0));
        // Onset: the torque swings by more than a hundredth of its limit.
        if onset.is_none() && (answer.commands[0].tau - 5.0).abs() > 0.87 {
            onset = Some(k);
        }
        if let (Some((fault, _)), None) = (answer.report.fault, found) {
            assert_eq!(fault, Fault::Oscillation);
            found = Some(k);
        }
    }
    println!("F10: onset at {onset:?}, stopped at {found:?}");
    assert!(found.unwrap() - onset.unwrap() <= 50);
    assert!(arm.truth[0].dq.abs() < 0.5 && arm.truth[0].q.abs() < 0.1, "{:?}", arm.truth);
}

/// Holds the same motion with and without something at a sample; the torque difference at that sample.
fn torques(schedule: bool, samples: usize) -> Vec<(f64, bool)> {
    let joint = JointOptions { start: schedule.then(|| gains(FIRST)), ..JointOptions::default() };
    let first = if schedule { SECOND } else { FIRST };
    let mut arm = Arm::<1>::new(first, joint);
    arm.truth[0].load = 40.0;
    arm.start();
    let begin = arm.time();
    let mut out = Vec::new();
    for _ in 0..samples {
        let (s, c) = (2.0 * (arm.time() - begin)).sin_cos();
        let answer = arm.step(&at(0.3 * (1.0 - c), 0.6 * s, 1.2 * c));
        out.push((answer.commands[0].tau, answer.report.events.contains(Events::RAISED)));
    }
    out
}

#[test]
fn f16_the_order_rises_without_a_step_in_torque() {
    let (with, without) = (torques(true, 2000), torques(false, 2000));
    let switch = with.iter().position(|(_, raised)| *raised).unwrap();
    let mut worst = 0.0_f64;
    for (a, b) in with.iter().zip(&without).take(switch + 2) {
        worst = worst.max((a.0 - b.0).abs());
    }
    println!(
        "F16: switch at sample {switch}, torque differs by {worst:.1e} N·m up to the sample after it"
    );
    assert!(switch > 90 && worst <= 1e-3, "{worst}");
    let at_switch = (with[switch].0 - without[switch].0).abs();
    assert!(at_switch <= 1e-9, "{at_switch}");
}

#[test]
fn f16_a_disturbance_brings_the_start_gains_back_after_the_dwell() {
    let joint = JointOptions { start: Some(gains(FIRST)), ..JointOptions::default() };
    let schedule = Schedule { settled: 0.5, disturbed: 1.5, dwell_s: 0.05 };
    let mut arm = Arm::<1>::with(SECOND, joint, &Options { schedule, ..Options::new(T_NS) });
    arm.start();
    let mut events = Vec::new();
    for k in 0..4000 {
        // From 1 s to 2 s the load swings.
        let t = f64::from(k) * T;
        arm.truth[0].load = if (1.0..2.0).contains(&t) { 40.0 * (25.0 * t).sin() } else { 0.0 };
        let answer = arm.step(&at(0.0, 0.0, 0.0));
        for event in [Events::RAISED, Events::LOWERED] {
            if answer.report.events.contains(event) {
                events.push((k, event));
            }
        }
    }
    println!("F16: {events:?}");
    let kinds: Vec<_> = events.iter().map(|e| e.1).collect();
    assert_eq!(kinds, [Events::RAISED, Events::LOWERED, Events::RAISED]);
    for pair in events.windows(2) {
        assert!(pair[1].0 - pair[0].0 >= 50, "the dwell holds: {pair:?}");
    }
}

#[test]
fn f26_gains_change_while_the_arm_runs() {
    let mut dice = Dice(26);
    let mut arm = Arm::<1>::new(SECOND, JointOptions::default());
    arm.truth[0].load = 30.0;
    arm.start();
    let (mut worst, mut error) = (0.0_f64, 0.0_f64);
    for _ in 0..2000 {
        let wave = |t: f64| at::<1>(0.3 * t.sin(), 0.3 * t.cos(), -0.3 * t.sin());
        for _ in 0..dice.bits() % 100 {
            let r = wave(arm.time());
            error = error.max((arm.truth[0].q - r[0].q).abs());
            arm.step(&r);
        }
        let r = wave(arm.time());
        // What the old gains would have answered to the next sample.
        let mut other = (arm.supervisor.clone(), arm.state, arm.truth, arm.k);
        let kp = dice.within(100.0, 600.0);
        let a = [FIRST, SECOND][(dice.bits() % 2) as usize];
        let design = JointDesign {
            inertia: 1.0,
            kp,
            kd: 2.0 * kp.sqrt(),
            a,
            period: T,
            form: Form::Observer,
        };
        let limits = Limits::new(Some(87.0), Some(1000.0), T).unwrap();
        let new = JointGains::new(&design).unwrap().with_limits(limits);
        arm.supervisor.change_gains(&mut arm.state, [new]).unwrap();
        let with = arm.step(&r).commands[0].tau;
        let kept = (arm.supervisor.clone(), arm.state, arm.truth, arm.k);
        (arm.supervisor, arm.state, arm.truth, arm.k) = other;
        let without = arm.step(&r).commands[0].tau;
        worst = worst.max((with - without).abs());
        other = kept;
        (arm.supervisor, arm.state, arm.truth, arm.k) = other;
    }
    println!("F26: torque differs by {worst:.1e} N·m at a change; error {error:.1e} rad");
    assert!(worst <= 1e-9 && error < 1e-1, "{worst} {error}");
}

#[test]
fn f22_a_wrong_sign_or_a_dead_drive_stops_at_first_motion() {
    for (drive, load) in [(-1.0, 5.0), (-1.0, 20.0), (0.0, 3.0)] {
        let joint = JointOptions {
            first_motion: Some(0.5),
            error_stop: Some(0.02),
            ..JointOptions::default()
        };
        let mut arm = Arm::<3>::new(SECOND, joint);
        arm.start();
        let here = arm.truth[1].q;
        // From now on this joint does not do what it is told, and carries a load.
        (arm.truth[1].drive, arm.truth[1].load) = (drive, load);
        let mut found = None;
        for k in 0..200 {
            let answer = arm.step(&at(0.0, 0.0, 0.0));
            if let (Some((fault, joint)), None) = (answer.report.fault, found) {
                println!(
                    "F22: drive {drive}, load {load}: {fault:?} of joint {joint} after {k} ms"
                );
                assert_eq!(joint, 1);
                found = Some((k, (arm.truth[1].q - here).abs()));
            }
        }
        let (after, moved) = found.unwrap();
        assert!(after <= 50 && moved <= 0.02, "drive {drive}: {after} ms, {moved} rad");
    }
    // No false alarm: a healthy joint, light or heavy, loaded or not.
    for inertia in [0.4, 1.0, 3.0] {
        for load in [0.0, 5.0, 20.0] {
            let joint = JointOptions { first_motion: Some(0.5), ..JointOptions::default() };
            let mut arm = Arm::<1>::new(SECOND, joint);
            arm.start();
            (arm.truth[0].inertia, arm.truth[0].load) = (inertia, load);
            for _ in 0..300 {
                let answer = arm.step(&at(0.0, 0.0, 0.0));
                assert_eq!(answer.report.fault, None, "J {inertia} load {load}");
            }
        }
    }
}

/// Peak-to-peak of the last 20 s under stiction: the friction holds up to `stick`, slides at 70 % of it.
fn hunting(dead_zone: Option<f64>) -> f64 {
    let joint = JointOptions { dead_zone, ..JointOptions::default() };
    let mut arm = Arm::<1>::new(FIRST, joint);
    arm.start();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let stick = 8.0;
    for k in 0..40_000 {
        let before = arm.truth[0];
        // Karnopp's friction, the load of this interval from the torque that is about to act.
        let tau = before.tau;
        let still = before.dq.abs() < 1e-4;
        arm.truth[0].load = if still && tau.abs() < stick {
            tau
        } else {
            0.7 * stick * if still { tau } else { before.dq }.signum()
        };
        arm.step(&at(if k < 100 { 0.0 } else { 0.0123 }, 0.0, 0.0));
        let now = &mut arm.truth[0];
        // Sliding friction stops a joint; it does not turn it round.
        if before.dq * now.dq < 0.0 || (still && now.tau.abs() < stick) {
            now.dq = 0.0;
        }
        if k > 20_000 {
            (low, high) = (low.min(arm.truth[0].q), high.max(arm.truth[0].q));
        }
    }
    high - low
}

#[test]
fn f23_the_dead_zone_ends_hunting_under_stiction() {
    let (without, with) = (hunting(None), hunting(Some(1e-3)));
    println!("F23: hunting {without:.1e} rad without, {with:.1e} rad with a dead zone of 1e-3 rad");
    assert!(without > 1e-4 && with < 1e-6, "{without} {with}");
}

#[test]
fn the_funnel_bounds_the_error_until_the_estimator_takes_over() {
    for inertia in [0.6, 1.0, 1.5] {
        for load in [-20.0, 10.0, 25.0] {
            let funnel = Funnel { initial: 0.1, r#final: 0.04, decay_s: 0.2 };
            let joint = JointOptions { funnel: Some(funnel), ..JointOptions::default() };
            let mut arm = Arm::<1>::new(SECOND, joint);
            arm.truth[0].inertia = inertia;
            arm.start();
            let begin = arm.time();
            // Unknown load from the first sample on: no preset.
            arm.truth[0].load = load;
            let (mut over, mut left) = (None, false);
            for k in 0..4000 {
                let psi = 0.04 + 0.06 * (-(arm.time() - begin) / 0.2_f64).exp();
                let answer = arm.step(&at(0.0, 0.0, 0.0));
                let inside = arm.truth[0].q.abs() < psi;
                left |= answer.report.events.contains(Events::FUNNEL_LEFT);
                if over.is_none() {
                    assert!(inside, "J {inertia} load {load}: {} at {k}", arm.truth[0].q);
                }
                if answer.report.events.contains(Events::FUNNEL_OVER) {
                    over = Some(k);
                }
            }
            println!("funnel: J {inertia}, load {load}: handed over after {over:?} ms");
            assert!(over.is_some() && !left, "{over:?} {left}");
            assert!(arm.truth[0].q.abs() < 1e-6, "{:?}", arm.truth);
        }
    }
    // Too much load for the funnel is an event, not a surprise.
    let funnel = Funnel { initial: 0.002, r#final: 0.001, decay_s: 0.1 };
    let joint = JointOptions { funnel: Some(funnel), ..JointOptions::default() };
    let mut arm = Arm::<1>::new(SECOND, joint);
    arm.start();
    arm.truth[0].load = 60.0;
    let left =
        (0..500).any(|_| arm.step(&at(0.0, 0.0, 0.0)).report.events.contains(Events::FUNNEL_LEFT));
    assert!(left);
}

#[test]
fn f17_no_subnormal_stays_in_a_state() {
    let mut arm = Arm::<1>::new(THIRD, JointOptions::default());
    arm.start();
    arm.truth[0].dq = 1e-140;
    for _ in 0..200_000 {
        arm.step(&at(0.0, 0.0, 0.0));
        let phi = arm.state.joints[0].phi_hat();
        assert!(phi == 0.0 || phi.abs() > 1e-300, "{phi:e}");
    }
    assert_eq!(arm.state.arm.mode(), Mode::Tracking);
    let _ = Reference::<f64>::default();
}
