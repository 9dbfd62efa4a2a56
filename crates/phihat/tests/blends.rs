//! From one reference, one set of gains, one law to another. Wrong if what is blended is another curve than the stated
//! one, or if a torque jumps, comes back late, or not at all.
#![allow(clippy::large_types_passed_by_value, reason = "a test reads better so")]

use crate::arm::{FIRST, SECOND};
use crate::joint::{INERTIA, Joint, T, T_NS, gains, outer};
use phihat::{
    Events, Form, Funnel, JointDesign, JointGains, JointOptions, Limits, Measurement, Mode,
    ModeRequest, MotionLimits, OptionError, Options, Reference, Schedule, Supervisor,
};

/// Value and first two derivatives at `s` of the quintic with these three at 0 and none at 1: Hermite's basis.
fn quintic([x, v, a]: [f64; 3], s: f64) -> [f64; 3] {
    // Low to high.
    let basis = [
        [1.0, 0.0, 0.0, -10.0, 15.0, -6.0],
        [0.0, 1.0, 0.0, -6.0, 8.0, -3.0],
        [0.0, 0.0, 0.5, -1.5, 1.5, -0.5],
    ];
    let mut value = [0.0; 3];
    for (weight, own) in [x, v, a].iter().zip(basis) {
        for (i, c) in own.iter().enumerate() {
            let power = |n: usize| std::iter::repeat_n(s, i.saturating_sub(n)).product::<f64>();
            let i = i as f64;
            value[0] += weight * c * power(0);
            value[1] += weight * c * i * power(1);
            value[2] += weight * c * i * (i - 1.0) * power(2);
        }
    }
    value
}

fn close(is: &Reference<f64>, want: &Reference<f64>, what: &str) {
    let off = (is.q - want.q).abs() + (is.dq - want.dq).abs() + (is.ddq - want.ddq).abs();
    assert!(off < 1e-9, "{what}: {is:?} against {want:?}");
}

#[test]
fn a_blend_is_the_quintic_between_two_motions() {
    let options = Options { blend_s: 0.25, ..Options::new(T_NS) };
    let mut joint = Joint::new(gains(400.0, 40.0, FIRST), JointOptions::default(), &options);
    let m = Measurement { q: 0.4, ..Measurement::default() };
    // A target that moves and accelerates.
    let target = |k: u32| {
        let t = f64::from(k) * T;
        Reference { q: 0.1 + 0.7 * t - 0.4 * t * t, dq: 0.7 - 0.8 * t, ddq: -0.8 }
    };
    joint.hold(m, target(0));
    close(joint.state.joints[0].reference(), &Reference { q: 0.4, ..Reference::default() }, "held");
    let first = target(0);
    let apart = |now: &Reference<f64>, to: &Reference<f64>, length: f64| {
        [now.q - to.q, (now.dq - to.dq) * length, (now.ddq - to.ddq) * length * length]
    };
    let start = apart(&Reference { q: 0.4, ..Reference::default() }, &first, 0.25);
    let mut now = Reference::default();
    for k in 0..300_u32 {
        joint.step(ModeRequest::Track, m, target(k));
        let [x, v, a] = quintic(start, (f64::from(k) / 250.0).min(1.0));
        let to = target(k);
        let want = Reference { q: to.q + x, dq: to.dq + v / 0.25, ddq: to.ddq + a / (0.25 * 0.25) };
        now = *joint.state.joints[0].reference();
        close(&now, &want, &format!("sample {k}"));
    }
    // Back to rest, ahead by half the way that the speed would go in the same time.
    let from = now;
    let home = Reference { q: from.q + 0.5 * from.dq * 0.25, ..Reference::default() };
    let start = apart(&from, &home, 0.25);
    for k in 0..300_u32 {
        let answer = joint.step(ModeRequest::Hold, m, target(300 + k));
        assert_eq!(answer.report.mode, Mode::Holding);
        let [x, v, a] = quintic(start, (f64::from(k) / 250.0).min(1.0));
        let want = Reference { q: home.q + x, dq: v / 0.25, ddq: a / (0.25 * 0.25) };
        close(joint.state.joints[0].reference(), &want, &format!("settling, sample {k}"));
    }
}

#[test]
fn behind_a_governor_a_motion_settles_where_it_can_stop() {
    let motion = MotionLimits { velocity: 1.0, acceleration: 4.0, jerk: 60.0 };
    let joint = JointOptions { motion: Some(motion), ..JointOptions::default() };
    let mut joint = Joint::new(gains(400.0, 40.0, FIRST), joint, &Options::new(T_NS));
    let m = Measurement::default();
    joint.hold(m, Reference::default());
    for speed in [0.8, -0.6_f64] {
        let begin = joint.state.joints[0].reference().q;
        for k in 0..4000_u32 {
            let q = begin + speed * f64::from(k) * T;
            joint.step(ModeRequest::Track, m, Reference { q, dq: speed, ddq: 0.0 });
        }
        let from = *joint.state.joints[0].reference();
        assert!((from.dq - speed).abs() < 1e-9);
        for _ in 0..4000 {
            joint.step(ModeRequest::Hold, m, Reference::default());
        }
        // v²/2A to brake, and v A/2J more since the braking has to build up.
        let way = speed * (speed.abs() / (2.0 * 4.0) + 4.0 / (2.0 * 60.0));
        let at = joint.state.joints[0].reference();
        assert!((at.q - from.q - way).abs() < 1e-6 && at.dq.abs() < 1e-6, "{at:?} from {from:?}");
    }
}

#[test]
fn a_reference_counts_as_shaped_where_the_one_in_force_is_another() {
    let motion = MotionLimits { velocity: 1.0, acceleration: 4.0, jerk: 60.0 };
    let joint = JointOptions { motion: Some(motion), ..JointOptions::default() };
    let mut joint = Joint::new(gains(400.0, 40.0, FIRST), joint, &Options::new(T_NS));
    let m = Measurement::default();
    joint.hold(m, Reference::default());
    let (mut shaped, mut passed) = (0, 0);
    for k in 0..3000_u32 {
        // A rest, a jump, and a motion that starts gently where the jump has ended.
        let t = f64::from(k) * T;
        let jump = if t < 0.1 { 0.0 } else { 0.2 };
        let s = 2.0 * (t - 1.5).max(0.0);
        let q = jump + 0.05 * (s - s.sin());
        let asked = Reference { q, dq: 0.1 * (1.0 - s.cos()), ddq: 0.2 * s.sin() };
        let told = joint.step(ModeRequest::Track, m, asked).report.events;
        let other = *joint.state.joints[0].reference() != asked;
        assert_eq!(told.contains(Events::SHAPED), other, "at {t} s");
        (shaped, passed) = (shaped + u32::from(other), passed + u32::from(!other));
    }
    assert!(shaped > 100 && passed > 500, "{shaped} {passed}");
}

/// Share left at `s` of a torque that fades: the cubic that is flat at both ends.
fn left(s: f64) -> f64 {
    if s < 1.0 { 1.0 - s * s * (3.0 - 2.0 * s) } else { 0.0 }
}

#[test]
fn what_new_gains_demand_differently_fades_out() {
    let options = Options { blend_s: 0.1, ..Options::new(T_NS) };
    let mut joint = Joint::new(gains(400.0, 40.0, SECOND), JointOptions::default(), &options);
    let at = |k: u32| Measurement { q: 0.01 + 1e-5 * f64::from(k), dq: 0.02, tau_applied: 3.0 };
    let r = Reference { q: 0.0, dq: 0.1, ddq: 0.3 };
    joint.hold(at(0), r);
    for k in 1..800 {
        joint.step(ModeRequest::Track, at(k), r);
    }
    let (mut differs, mut begun) = (Vec::new(), 0);
    for k in 800..1100 {
        if k == 800 || k == 840 {
            // The second change comes while the first still fades.
            let (kp, kd) = if k == 800 { (900.0, 60.0) } else { (200.0, 20.0) };
            joint.arm.change_gains(&mut joint.state, [gains(kp, kd, SECOND)]).unwrap();
            let old = if k == 800 { (400.0, 40.0) } else { (900.0, 60.0) };
            let m = at(k);
            let remains = differs.last().map_or(0.0, |first: &f64| first * left(0.4));
            let step = outer(old.0, old.1, &m, &r) - outer(kp, kd, &m, &r);
            differs.push(remains + step);
            begun = k;
        }
        let (kp, kd) = if k < 840 { (900.0, 60.0) } else { (200.0, 20.0) };
        let command = joint.step(ModeRequest::Track, at(k), r).commands[0];
        let fading = differs.last().unwrap() * left(f64::from(k - begun) / 100.0);
        let want = outer(kp, kd, &at(k), &r) + command.phi_hat + fading;
        assert!((command.tau - want).abs() < 1e-9, "sample {k}: {} against {want}", command.tau);
    }
    assert!(differs.iter().all(|d| d.abs() > 0.5), "{differs:?}");
}

#[test]
fn inside_the_funnel_the_stated_law_runs_until_it_hands_over() {
    let funnel = Funnel { initial: 0.1, r#final: 0.03, decay_s: 0.05 };
    let joint = JointOptions { funnel: Some(funnel), ..JointOptions::default() };
    let options = Options {
        blend_s: 0.2,
        schedule: Schedule { dwell_s: 0.1, ..Options::new(T_NS).schedule },
        ..Options::new(T_NS)
    };
    let (kp, kd, a) = (400.0, 40.0, 55.0);
    let mut joint = Joint::new(gains(kp, kd, &[a]), joint, &options);
    // The estimator's own gain, sampled.
    let most = 1.0 + -(-a * T).exp_m1() / T / kd;
    let m = |k: u32| {
        let t = f64::from(k) * T;
        Measurement { q: 0.028 * (40.0 * t).sin(), dq: 1.12 * (40.0 * t).cos(), tau_applied: 2.0 }
    };
    let still = Measurement::default();
    joint.step(ModeRequest::Arm, still, Reference::default());
    let (mut over, mut difference, mut bounded) = (None, 0.0, [0; 2]);
    for k in 0..900_u32 {
        // From 0.3 s on the error is beyond the funnel now and then.
        let mut m = if k == 0 { still } else { m(k) };
        m.q *= if (200..210).contains(&k) { 2.0 } else { 1.0 };
        let answer = joint.step(ModeRequest::Hold, m, Reference::default());
        let command = answer.commands[0];
        let law = outer(kp, kd, &m, &Reference::default()) + command.phi_hat;
        let psi = 0.03 + 0.07 * (-f64::from(k) * T / 0.05).exp();
        let room = 1.0 - (m.q / psi).powi(2);
        let g = if room > 0.0 { (1.0 / room).min(most) } else { most };
        let inside = -INERTIA * (g * kd * m.dq + g * g * kp * m.q);
        if let Some(over) = over {
            let since = f64::from(k - over) / 200.0;
            let want = law + difference * left(since);
            assert!((command.tau - want).abs() < 1e-6, "{k}: {} against {want}", command.tau);
            assert!(!answer.report.events.contains(Events::FUNNEL));
            continue;
        }
        assert!(answer.report.events.contains(Events::FUNNEL));
        assert_eq!(answer.report.events.contains(Events::FUNNEL_LEFT), room <= 0.0, "{k}");
        bounded[usize::from(g < most)] += 1;
        if answer.report.events.contains(Events::FUNNEL_OVER) {
            (over, difference) = (Some(k), inside - law);
        }
        // At the hand-over, too: what the law demands differently fades from here.
        assert!((command.tau - inside).abs() < 1e-6, "{k}: {command:?} against {inside}");
    }
    // ψ is within 5 % of its end after 0.05 ln(0.07/0.0015) s = 0.192 s; 0.1 s later it hands over.
    assert!((290..=294).contains(&over.unwrap()), "{over:?}");
    assert!(bounded.iter().all(|n| *n > 10), "{bounded:?}");
}

/// A joint in a funnel, and the width ψ that is stated at a sample.
fn in_a_funnel(funnel: Funnel) -> (Joint, impl Fn(u32) -> f64) {
    let joint = JointOptions { funnel: Some(funnel), ..JointOptions::default() };
    let options = Options { blend_s: 0.05, ..Options::new(T_NS) };
    let joint = Joint::new(gains(400.0, 40.0, &[55.0]), joint, &options);
    let Funnel { initial, r#final, decay_s } = funnel;
    (joint, move |k| r#final + (initial - r#final) * (-f64::from(k) * T / decay_s).exp())
}

/// Torque demand of the funnel at a width \[N·m\].
fn demanded(psi: f64, m: &Measurement<f64>, at: &Reference<f64>) -> f64 {
    let most = 1.0 + -(-55.0 * T).exp_m1() / T / 40.0;
    let g = (1.0 / (1.0 - ((m.q - at.q) / psi).powi(2))).min(most);
    INERTIA * (at.ddq - g * 40.0 * (m.dq - at.dq) - g * g * 400.0 * (m.q - at.q))
}

#[test]
fn a_funnel_is_about_the_reference_that_is_in_force() {
    let (mut joint, psi) = in_a_funnel(Funnel { initial: 0.1, r#final: 0.05, decay_s: 0.1 });
    let mut m = Measurement { q: 0.4, ..Measurement::default() };
    joint.hold(m, Reference::default());
    for k in 1..250_u32 {
        let t = f64::from(k) * T;
        let asked = Reference { q: 0.4 + 0.3 * t * t, dq: 0.6 * t, ddq: 0.6 };
        m = Measurement { q: 0.42 + 0.3 * t * t, dq: 0.6 * t + 0.1, tau_applied: 1.0 };
        let mode = if k < 20 { ModeRequest::Hold } else { ModeRequest::Track };
        let answer = joint.step(mode, m, asked);
        assert!(answer.report.events.contains(Events::FUNNEL), "{k}");
        let want = demanded(psi(k), &m, joint.state.joints[0].reference());
        let tau = answer.commands[0].tau;
        assert!((tau - want).abs() < 1e-6 * (1.0 + want.abs()), "{k}: {tau} against {want}");
    }
    assert!(joint.state.joints[0].reference().dq > 0.1);
}

#[test]
fn a_funnel_that_does_not_get_narrower_acts_all_the_same() {
    let (mut joint, psi) = in_a_funnel(Funnel { initial: 0.05, r#final: 0.05, decay_s: 0.1 });
    let m = Measurement { q: 0.03, ..Measurement::default() };
    joint.hold(Measurement::default(), Reference::default());
    // From the sample on at which the law starts, for the dwell of 0.1 s.
    for k in 1..140_u32 {
        let answer = joint.step(ModeRequest::Hold, m, Reference::default());
        let told = answer.report.events;
        assert_eq!(told.contains(Events::FUNNEL), k < 100, "{k}");
        assert_eq!(told.contains(Events::FUNNEL_OVER), k == 99, "{k}");
        if k < 99 {
            let want = demanded(psi(k), &m, &Reference::default());
            assert!((answer.commands[0].tau - want).abs() < 1e-9, "{k}");
        }
    }
}

#[test]
fn a_stop_knows_no_funnel() {
    let (mut joint, _) = in_a_funnel(Funnel { initial: 0.1, r#final: 0.05, decay_s: 1.0 });
    let m = Measurement { q: 0.4, ..Measurement::default() };
    joint.hold(m, Reference::default());
    joint.step(ModeRequest::Hold, m, Reference::default());
    // It is pushed off its place, and stands there.
    let m = Measurement { q: 0.43, tau_applied: 2.0, ..m };
    joint.step(ModeRequest::Stop, m, Reference::default());
    for k in 0..100 {
        let answer = joint.step(ModeRequest::Stop, m, Reference::default());
        assert!(!answer.report.events.contains(Events::FUNNEL), "{k}");
        let at = *joint.state.joints[0].reference();
        let law = outer(400.0, 40.0, &m, &at) + answer.commands[0].phi_hat;
        assert!((answer.commands[0].tau - law).abs() < 1e-9, "{k}: {:?} {law}", answer.commands);
    }
}

#[test]
fn after_a_blend_the_reference_is_the_callers_to_the_last_bit() {
    for blend_s in [0.125, 0.25, 0.5] {
        let options = Options { blend_s, ..Options::new(T_NS) };
        let mut joint = Joint::new(gains(400.0, 40.0, FIRST), JointOptions::default(), &options);
        let m = Measurement { q: 0.1, ..Measurement::default() };
        let asked = Reference { q: 0.7, dq: 0.3, ddq: -0.7 };
        joint.hold(m, asked);
        for k in 0..600_u32 {
            joint.step(ModeRequest::Track, m, asked);
            let over = f64::from(k) * T >= blend_s - 1e-9;
            let at = joint.state.joints[0].reference();
            let bits = |r: &Reference<f64>| [r.q, r.dq, r.ddq].map(f64::to_bits);
            assert_eq!(bits(at) == bits(&asked), over, "{blend_s} s, {k}: {at:?}");
        }
    }
}

#[test]
fn running_gains_come_after_the_dwell_and_go_again() {
    let schedule = Schedule { settled: 1.0, disturbed: 3.0, dwell_s: 0.4 };
    let options = Options { schedule, ..Options::new(T_NS) };
    let start = JointOptions { start: Some(gains(400.0, 40.0, FIRST)), ..JointOptions::default() };
    for (off, raised) in [(0.9, true), (-0.9, true), (1.1, false), (-1.1, false)] {
        let mut joint = Joint::new(gains(400.0, 40.0, SECOND), start, &options);
        let mut m = Measurement::default();
        joint.hold(m, Reference::default());
        let (mut squares, mut mean, mut found) = (0.0_f64, 0.0, Vec::new());
        for k in 0..3000_u32 {
            // The mismatch between what is seen and what is estimated is this, from the first sample on.
            let off = if k < 1500 { off } else { 4.0 };
            m.dq = 1e-3 * f64::from(k);
            let moved = INERTIA * 1e-3 / T * f64::from(u8::from(k > 0));
            m.tau_applied = joint.state.joints[0].phi_hat() + off + moved;
            let events = joint.step(ModeRequest::Hold, m, Reference::default()).report.events;
            mean += 0.02 * (off - mean);
            squares += 0.02 * (mean * mean - squares);
            for event in [Events::RAISED, Events::LOWERED] {
                if events.contains(event) {
                    found.push((k, event));
                }
            }
        }
        println!("mismatch {off}: {found:?}");
        let up: Vec<_> = found.iter().filter(|f| f.1 == Events::RAISED).collect();
        assert_eq!(up.len(), usize::from(raised), "{off}: {found:?}");
        assert!(!raised || up[0].0.abs_diff(400) <= 2, "after the dwell: {found:?}");
        // The mean of some 50 samples needs 0.1 s to pass 3 of 4 N·m; 0.4 s later the start gains are back.
        let down: Vec<_> = found.iter().filter(|f| f.1 == Events::LOWERED).collect();
        assert_eq!(down.len(), usize::from(raised), "{off}: {found:?}");
        let (mut x, mut s) = (off, off * off);
        let beyond = |_: &u32| {
            x += 0.02 * (4.0 - x);
            s += 0.02 * (x * x - s);
            s > 9.0
        };
        let n = (1..1000).find(beyond).unwrap();
        assert!(!raised || down[0].0.abs_diff(1500 + n + 400) <= 3, "{n}: {found:?}");
    }
}

#[test]
fn without_start_gains_or_without_samples_nothing_is_raised() {
    let schedule = Schedule { settled: 1.0, disturbed: 3.0, dwell_s: 0.1 };
    let options = Options { schedule, hold_samples: 50, stop_samples: 50, ..Options::new(T_NS) };
    let m = Measurement::default();
    let mut plain = Joint::new(gains(400.0, 40.0, SECOND), JointOptions::default(), &options);
    plain.hold(m, Reference::default());
    for _ in 0..400 {
        let told = plain.step(ModeRequest::Hold, m, Reference::default());
        assert!(!told.report.events.contains(Events::RAISED));
    }
    // Samples that are missed do not count as settled; nor does an arm that only is armed.
    let start = JointOptions { start: Some(gains(400.0, 40.0, FIRST)), ..JointOptions::default() };
    let mut joint = Joint::new(gains(400.0, 40.0, SECOND), start, &options);
    for _ in 0..300 {
        let told = joint.step(ModeRequest::Arm, m, Reference::default());
        assert!(!told.report.events.contains(Events::RAISED));
    }
    let mut fresh = 0;
    let raised = (0..400).find(|k| {
        let answer = if k % 4 == 0 {
            joint.miss(ModeRequest::Hold, Reference::default())
        } else {
            fresh += 1;
            joint.step(ModeRequest::Hold, m, Reference::default())
        };
        answer.report.events.contains(Events::RAISED)
    });
    assert!(raised.is_some() && fresh == 100, "{raised:?} after {fresh} samples");
}

#[test]
fn gains_for_another_period_are_refused_and_change_nothing() {
    let mut joint =
        Joint::new(gains(400.0, 40.0, FIRST), JointOptions::default(), &Options::new(T_NS));
    joint.hold(Measurement::default(), Reference::default());
    for (share, fits) in
        [(2.0, false), (1.0 + 2e-6, false), (1.0 - 2e-6, false), (1.0 + 5e-7, true)]
    {
        let design = JointDesign {
            inertia: INERTIA,
            kp: 100.0,
            kd: 20.0,
            a: FIRST,
            period: share * T,
            form: Form::Observer,
        };
        let other = JointGains::new(&design).unwrap();
        let (arm, state) = (joint.arm.clone(), joint.state);
        let is = joint.arm.change_gains(&mut joint.state, [other]);
        assert_eq!(is.is_ok(), fits, "{share}");
        if !fits {
            assert_eq!(is, Err(OptionError::Period { joint: 0 }));
            assert!(joint.arm == arm && joint.state == state);
        }
        let options = JointOptions { start: Some(other), ..JointOptions::default() };
        let own = gains(400.0, 40.0, FIRST);
        assert_eq!(
            Supervisor::new([own], &[options], &Options::new(T_NS)).is_ok(),
            fits,
            "{share}"
        );
    }
    // And funnels that widen, or never end.
    for initial in [0.01, f64::INFINITY, f64::NAN] {
        let funnel = Funnel { initial, r#final: 0.02, decay_s: 0.1 };
        let options = JointOptions { funnel: Some(funnel), ..JointOptions::default() };
        let own = gains(400.0, 40.0, FIRST);
        assert!(Supervisor::new([own], &[options], &Options::new(T_NS)).is_err(), "{initial}");
    }
}

/// Torques around a change of gains, under a load that rises at 40 N·m/s and is held.
fn around(from: &JointGains<f64>, to: &JointGains<f64>, slope: f64) -> [f64; 3] {
    let mut joint = Joint::new(*from, JointOptions::default(), &Options::new(T_NS));
    let at = |k: u32| Measurement { q: 1e-3, dq: 0.0, tau_applied: 5.0 + slope * f64::from(k) * T };
    joint.hold(at(0), Reference::default());
    let mut torques = [0.0; 3];
    for k in 1..1500 {
        if k == 1499 {
            joint.arm.change_gains(&mut joint.state, [*to]).unwrap();
        }
        let r = Reference { q: 0.0, ..Reference::default() };
        torques.rotate_left(1);
        torques[2] = joint.step(ModeRequest::Track, at(k), r).commands[0].tau;
    }
    torques
}

#[test]
fn a_change_of_order_form_or_inertia_goes_on_where_the_torque_was() {
    let made = |form, a, inertia| {
        let design = JointDesign { inertia, kp: 400.0, kd: 40.0, a, period: T, form };
        JointGains::new(&design).unwrap()
    };
    let third: &[f64] = &[343_000.0, 14_700.0, 210.0];
    let observer = |a| made(Form::Observer, a, INERTIA);
    let literal = |a| made(Form::Literal, a, INERTIA);
    for (from, to, slope, tolerance) in [
        // The slope goes on for a sample where the lower order does not know it.
        (observer(SECOND), observer(FIRST), 40.0, 4e-3),
        (observer(third), observer(SECOND), 40.0, 1e-6),
        (observer(SECOND), observer(third), 40.0, 1e-6),
        (observer(SECOND), made(Form::Observer, SECOND, 1.4), 40.0, 1e-6),
        // Between the forms the torque continues; then the observer learns, by 7 % a sample, that another one acted.
        (literal(FIRST), observer(FIRST), 0.0, 4.0),
        (observer(FIRST), literal(FIRST), 0.0, 0.5),
        (literal(SECOND), observer(SECOND), 0.0, 200.0),
    ] {
        let [before, last, now] = around(&from, &to, slope);
        let off = now - 2.0 * last + before;
        let (a, b) = (from.order(), to.order());
        println!("order {a} to {b}: {before:.4} {last:.4} {now:.4} N·m, off by {off:.1e}");
        assert!(off.abs() < tolerance, "order {a} to {b}: {before} {last} {now}");
        assert!(now.abs() > 1.0);
    }
}

/// If a rate limit acts, the estimate `φ̂` of the old gains is handed over, not the rest of their torque
/// behind the limit.
#[test]
fn in_the_printed_form_an_estimate_is_handed_over_behind_a_rate_limit() {
    let literal = |a| {
        let (kp, kd, form) = (400.0, 40.0, Form::Literal);
        let design = JointDesign { inertia: INERTIA, kp, kd, a, period: T, form };
        let limits = Limits::new(None, Some(100.0), T).unwrap();
        JointGains::new(&design).unwrap().with_limits(limits)
    };
    let mut joint = Joint::new(literal(&[20.0]), JointOptions::default(), &Options::new(T_NS));
    joint.hold(Measurement::default(), Reference::default());
    let m = Measurement { q: 0.05, ..Measurement::default() };
    let mut before = [0.0; 2];
    for _ in 0..20 {
        let command = joint.step(ModeRequest::Hold, m, Reference::default()).commands[0];
        assert!(command.status.rate_limited && command.tau > -3.0, "{command:?}");
        before = [before[1], command.phi_hat];
    }
    joint.arm.change_gains(&mut joint.state, [literal(&[40.0])]).unwrap();
    let after = joint.step(ModeRequest::Hold, m, Reference::default()).commands[0].phi_hat;
    // It goes on from there, by twice as much a sample.
    let step = 2.0 * (before[1] - before[0]);
    assert!((after - before[1] - step).abs() < 0.01 * step.abs(), "{before:?} {after}");
}
