//! Joint limits, sample by sample. Wrong if a torque passes that could not be braked before the end of the range, if a
//! hard limit is not where it is said, if a reference is kept elsewhere, or if an estimate grows outward at the end.

use crate::arm::{Dice, FIRST, SECOND};
use crate::joint::{INERTIA, Joint, T, T_NS, gains};
use phihat::{
    Command, Events, Fault, JointOptions, JointRange, Limits, Measurement, Mode, ModeRequest,
    Options, Reference, SupervisorState,
};

const KP: f64 = 400.0;
const KD: f64 = 40.0;
const RANGE: JointRange = JointRange { lower: -0.8, upper: 1.2, soft: 0.1, braking: 8.0 };
/// Limits of a reference \[rad\]: a quarter of the soft zone from the ends.
const ENDS: [f64; 2] = [RANGE.lower + 0.25 * RANGE.soft, RANGE.upper - 0.25 * RANGE.soft];

/// A joint with this range that tracks; a reference is blended within a sample.
fn tracking(a: &[f64], rate: Option<f64>) -> Joint {
    let gains = gains(KP, KD, a).with_limits(Limits::new(None, rate, T).unwrap());
    let options = JointOptions { range: Some(RANGE), ..JointOptions::default() };
    let mut joint = Joint::new(gains, options, &Options { blend_s: T, ..Options::new(T_NS) });
    joint.hold(Measurement::default(), Reference::default());
    for _ in 0..2 {
        joint.step(ModeRequest::Track, Measurement::default(), Reference::default());
    }
    joint
}

/// Room and outward speed once the torque has come down to braking: small steps of a joint whose torque falls
/// from `push` above the estimate by `rate`.
fn once_braking(room: f64, outward: f64, push: f64, rate: f64) -> (f64, f64) {
    let time = (push + INERTIA * RANGE.braking) / rate;
    if time <= 0.0 {
        return (room, outward);
    }
    let steps = 4000_u32;
    let dt = time / f64::from(steps);
    let (mut x, mut v) = (0.0, outward);
    for k in 0..steps {
        // The middle of the step.
        let a = (push - rate * dt * (f64::from(k) + 0.5)) / INERTIA;
        x += dt * (v + 0.5 * dt * a);
        v += dt * a;
    }
    (room - x, v)
}

/// The stated bound on an outward torque, where there is one.
fn ceiling(room: f64, outward: f64, phi_hat: f64, last: f64, rate: f64) -> Option<f64> {
    if room > RANGE.soft && outward <= 0.0 && last <= phi_hat {
        return None;
    }
    let (left, speed) = once_braking(room, outward, last - phi_hat, rate);
    if room >= RANGE.soft && (speed <= 0.0 || speed * speed <= RANGE.braking * left) {
        return None;
    }
    let v = (2.0 * RANGE.braking * left.max(0.0)).sqrt();
    // As much of the braking as the motion is fast; inward nothing.
    let braking = if speed > 0.0 { RANGE.braking * (speed / v).min(1.0) } else { 0.0 };
    let bound = phi_hat + INERTIA * (KD * (v - speed) - braking);
    Some(if room > 0.0 { bound } else { bound.min(0.0) })
}

#[test]
#[expect(clippy::too_many_lines, reason = "one drawn sample after another, judged in turn")]
fn no_torque_passes_that_could_not_be_braked_before_the_end() {
    let (mut capped, mut free, mut beyond) = ([0; 2], 0, [0; 2]);
    for limit in [None, Some(2e2), Some(2e3), Some(2e4), Some(2e5)] {
        let mut dice = Dice(60);
        let mut joint = tracking(SECOND, limit);
        let rate = limit.unwrap_or(f64::INFINITY);
        let step = rate * T;
        let mut m = Measurement::default();
        for k in 0..6000 {
            if k % 500 == 0 {
                (joint, m) = (tracking(SECOND, limit), Measurement::default());
            }
            // Often near an end; now and then somewhere else. In the last part of each block the arm is stopped, and
            // may be beyond.
            let stopped = k % 500 > 400;
            if dice.bits().is_multiple_of(4) {
                let near = 10.0_f64.powf(dice.within(-3.0, 0.0));
                let near =
                    if stopped && dice.bits().is_multiple_of(2) { -0.1 * near } else { near };
                let upper = dice.bits().is_multiple_of(2);
                m.q = if upper { RANGE.upper - near } else { RANGE.lower + near };
            }
            m.dq += dice.within(-0.05, 0.05) - 0.02 * m.dq;
            if dice.bits().is_multiple_of(10) {
                m.dq = dice.within(-3.0, 3.0);
            }
            m.tau_applied = dice.within(-20.0, 20.0);
            let r = Reference { q: dice.within(-3.0, 3.0), dq: dice.within(-2.0, 2.0), ddq: 0.0 };
            let last = joint.state.joints[0].tau();
            let mode = if stopped { ModeRequest::Stop } else { ModeRequest::Track };
            let answer = joint.step(mode, m, r);
            let Command { tau, phi_hat, .. } = answer.commands[0];
            let demand = if stopped {
                phi_hat - 0.5 * INERTIA * KD * m.dq
            } else {
                let at = joint.state.joints[0].reference();
                phi_hat + INERTIA * (at.ddq - KD * (m.dq - at.dq) - KP * (m.q - at.q))
            };
            let (above, below) = (RANGE.upper - m.q, m.q - RANGE.lower);
            let upper = ceiling(above, m.dq, phi_hat, last, rate).filter(|c| demand > *c);
            let lower = ceiling(below, -m.dq, -phi_hat, -last, rate).filter(|c| -demand > *c);
            let wanted = upper.or(lower.map(|c| -c)).unwrap_or(demand);
            let limited = last + (wanted - last).clamp(-step, step);
            let tolerance = 1e-5 * (1.0 + wanted.abs());
            // What a stop asks for is its own business; what it may is not.
            let within = |c: Option<f64>, tau: f64, last: f64| {
                c.is_none_or(|c| tau < last + (c - last).clamp(-step, step) + tolerance)
            };
            let ends = [
                ceiling(above, m.dq, phi_hat, last, rate),
                ceiling(below, -m.dq, -phi_hat, -last, rate),
            ];
            let conflict = matches!(ends, [Some(up), Some(down)] if up < -down);
            let held = conflict
                || within(ceiling(above, m.dq, phi_hat, last, rate), tau, last)
                    && within(ceiling(below, -m.dq, -phi_hat, -last, rate), -tau, -last);
            assert!(
                if stopped { held } else { (tau - limited).abs() < tolerance },
                "{m:?}: {tau} against {limited}, {upper:?} {lower:?} of {demand}, {rate} N·m/s {phi_hat} {last} {k} \
                    {:?}",
                answer.report
            );
            for (side, (cap, room)) in [(upper, above), (lower, below)].into_iter().enumerate() {
                capped[side] += u32::from(cap.is_some());
                beyond[side] += u32::from(cap.is_some() && room <= 0.0);
            }
            // Told where a torque was capped or the reference kept, and nowhere else.
            let kept = !stopped && (r.q > ENDS[1] || r.q < ENDS[0]);
            let told = answer.report.events.contains(Events::RANGE);
            let limits = upper.or(lower).is_some();
            free += u32::from(!limits);
            assert!(stopped || told == (kept || limits), "{m:?} {r:?} {upper:?} {lower:?}");
        }
    }
    println!("capped {capped:?}, beyond the end {beyond:?}, free {free}");
    assert!(capped.iter().all(|n| *n > 1000) && beyond.iter().all(|n| *n > 50) && free > 1000);
}

/// Just before the room from which on a torque is capped nothing acts, and just behind it something does, at
/// any torque rate, speed and torque before, at both ends.
#[test]
fn a_torque_is_capped_from_the_room_on_that_braking_takes() {
    let mut dice = Dice(61);
    for run in 0..120 {
        let rate = [100.0, 200.0, 1000.0, 1e4, f64::INFINITY][run % 5];
        let limit = rate.is_finite().then_some(rate);
        let sign = if dice.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut joint = tracking(FIRST, limit);
        // A torque that acts outward, or inward, of some size; or next to none.
        let size = if run % 2 == 0 { dice.within(-8.0, 25.0) } else { dice.within(-0.3, 0.3) };
        let push = sign * size;
        let outward = dice.within(0.2, 2.0);
        let m = Measurement { q: 0.2, dq: sign * outward, tau_applied: 0.0 };
        for _ in 0..500 {
            let asked = Reference { q: 0.2, dq: m.dq, ddq: push / INERTIA };
            joint.step(ModeRequest::Track, m, asked);
        }
        let last = joint.state.joints[0].tau();
        // Whatever is asked for, it is more than any cap.
        let told = |room: f64| {
            let q = if sign > 0.0 { RANGE.upper - room } else { RANGE.lower + room };
            let mut own = Joint { arm: joint.arm.clone(), state: joint.state, k: joint.k };
            let asked = Reference { q, dq: 0.0, ddq: sign * 1e5 };
            let answer = own.step(ModeRequest::Track, Measurement { q, ..m }, asked);
            (answer.report.events.contains(Events::RANGE), answer.commands[0].phi_hat)
        };
        let (_, phi_hat) = told(0.5);
        let caps = |room: f64| ceiling(room, outward, sign * phi_hat, sign * last, rate).is_some();
        let (mut low, mut high) = (RANGE.soft, 1.5);
        if caps(high) {
            continue;
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if caps(middle) { low = middle } else { high = middle }
        }
        assert!(!told(high * 1.0001).0, "{run}: nothing at {high} rad");
        if low > RANGE.soft {
            assert!(told(low * 0.9999).0, "{run}: capped at {low} rad");
        }
    }
}

#[test]
fn a_hard_limit_is_where_it_is_said() {
    for (q, fault) in [
        (RANGE.upper, false),
        (RANGE.lower, false),
        (RANGE.upper + 1e-9, true),
        (RANGE.lower - 1e-9, true),
        (RANGE.upper + 0.5, true),
        (RANGE.lower - 0.5, true),
    ] {
        let mut joint = tracking(SECOND, None);
        let m = Measurement { q, ..Measurement::default() };
        let told = joint.step(ModeRequest::Track, m, Reference::default()).report;
        assert_eq!(told.fault, fault.then_some((Fault::JointLimit, 0)), "{q}");
        assert_eq!(told.mode, if fault { Mode::SafeStop } else { Mode::Tracking });
        // An arm beyond its range does not start, either.
        let mut idle = tracking(SECOND, None);
        idle.state = SupervisorState::new();
        let told = idle.step(ModeRequest::Arm, m, Reference::default()).report;
        assert_eq!(told.mode, if fault { Mode::Idle } else { Mode::Armed }, "{q}");
    }
}

#[test]
fn a_reference_is_kept_a_quarter_of_the_soft_zone_from_the_end() {
    for (q, kept) in [
        (ENDS[1] + 1e-9, Some(ENDS[1])),
        (RANGE.upper, Some(ENDS[1])),
        (50.0, Some(ENDS[1])),
        (ENDS[1], None),
        (ENDS[0], None),
        (ENDS[1] - 1e-9, None),
        (0.0, None),
        (ENDS[0] + 1e-9, None),
        (ENDS[0] - 1e-9, Some(ENDS[0])),
        (-50.0, Some(ENDS[0])),
    ] {
        let mut joint = tracking(SECOND, None);
        let asked = Reference { q, dq: 0.3, ddq: 0.1 };
        let told = joint.step(ModeRequest::Track, Measurement::default(), asked).report;
        // Kept, it stands.
        let want = kept.map_or(asked, |q| Reference { q, dq: 0.0, ddq: 0.0 });
        let is = *joint.state.joints[0].reference();
        assert!((is.q - want.q).abs() < 1e-12, "{is:?} against {want:?}");
        assert!((is.dq - want.dq).abs() < 1e-12 && (is.ddq - want.ddq).abs() < 1e-12, "{is:?}");
        assert_eq!(told.events.contains(Events::RANGE), kept.is_some(), "{q}");
    }
}

#[test]
fn at_the_end_an_estimate_does_not_grow_outward() {
    for (q, load, frozen) in [
        (RANGE.upper - 0.09, 10.0, true),
        (RANGE.upper - 0.09, -10.0, false),
        (RANGE.upper - 0.11, 10.0, false),
        (RANGE.upper - RANGE.soft, 10.0, false),
        (RANGE.lower + RANGE.soft, -10.0, false),
        (RANGE.lower + 0.09, -10.0, true),
        (RANGE.lower + 0.09, 10.0, false),
        (RANGE.lower + 0.11, -10.0, false),
    ] {
        // First order, which does not overshoot.
        let mut joint = tracking(FIRST, None);
        // The joint stands, though it is pushed: an outward torque of `load` is learnt.
        let m = Measurement { q, dq: 0.0, tau_applied: load };
        let at = Reference { q, ..Reference::default() };
        let mut phi_hat = 0.0;
        for _ in 0..400 {
            phi_hat = joint.step(ModeRequest::Track, m, at).commands[0].phi_hat;
        }
        let want = if frozen { 0.0 } else { load };
        assert!((phi_hat - want).abs() < 0.01, "at {q} {load}: {phi_hat} against {want}");
    }
}

#[test]
fn f09_approaches_are_braked_at_any_torque_rate() {
    let mut dice = Dice(90);
    for rate in [200.0, 500.0, 1000.0, 5000.0] {
        let (mut deepest, mut fastest) = (0.0_f64, 0.0_f64);
        for _ in 0..150 {
            let mut joint = tracking(FIRST, Some(rate));
            let inertia = INERTIA * dice.within(0.8, 1.25);
            let (mut m, load) = (Measurement::default(), dice.within(-2.0, 2.0));
            let speed = dice.within(0.2, 2.0);
            let up = dice.bits().is_multiple_of(2);
            let sign = if up { 1.0 } else { -1.0_f64 };
            let mut r = Reference::<f64>::default();
            for k in 0..2500 {
                // From rest to a speed that leads out of the range.
                r.ddq = if r.dq.abs() < speed { sign * 4.0 } else { 0.0 };
                r.dq += T * r.ddq;
                r.q += T * r.dq;
                let answer = joint.step(ModeRequest::Track, m, r);
                let tau = answer.commands[0].tau;
                let ddq = (tau - load) / inertia;
                m.q += T * m.dq + 0.5 * T * T * ddq;
                m.dq += T * ddq;
                m.tau_applied = tau;
                deepest = deepest.max(m.q - RANGE.upper).max(RANGE.lower - m.q);
                if k > 500 && answer.report.events.contains(Events::RANGE) {
                    fastest = fastest.max(m.dq.abs());
                }
            }
        }
        println!("F9: {rate} N·m/s: deepest {deepest:.4} rad, limited up to {fastest:.1} rad/s");
        assert!(deepest <= 0.5_f64.to_radians() && fastest > 1.0, "{deepest} {fastest}");
    }
}
