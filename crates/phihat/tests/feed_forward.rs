//! Torque that is fed forward under supervision: it may come, go, be right, wrong or absurd, and the torque
//! goes on from where it was. The oracle is the plant's own load, and the same arm without feed-forward.
//! Wrong if φ̂ and the feed-forward do not add up to the holding torque wherever something holds the arm.
#![allow(clippy::large_types_passed_by_value, reason = "tests: a panic is the report")]

use std::collections::VecDeque;

use phihat::{
    Answer, Command, Events, Fault, Form, Funnel, JointDesign, JointGains, JointOptions,
    JointRange, Limits, Measurement, Mode, ModeRequest, MotionLimits, Options, PositionDesign,
    Reference, Request, Sample, Stamp, Supervisor, SupervisorState,
};

use crate::arm::Dice;

const T: f64 = 1e-3;
const T_NS: u64 = 1_000_000;
/// Of the torque, per sample \[N·m\].
const STEP_MAX: f64 = 1.0;
/// Nominal inertia.
const INERTIA: f64 = 0.8;

/// Four observer poles at `r`, so that φ̂ follows a ramp; `kind` of delay.
fn gains(r: f64, share: f64, delay: usize) -> JointGains<f64> {
    let x: f64 = 1.0 - r;
    // The fading-memory filter of third degree, in time units of T.
    let g = 1.0 - r.powi(4);
    let h = x * x * (11.0 + 14.0 * r + 11.0 * r * r) / 6.0;
    let k = x.powi(3) * 2.0 * (1.0 + r);
    let j = x.powi(4);
    let correction = [g, h / T, -k / (T * T), -j / (T * T * T)];
    let design = PositionDesign {
        inertia: INERTIA,
        kp: 400.0,
        kd: 40.0,
        correction: &correction,
        velocity_correction: &[],
        share,
        delay,
        period: T,
    };
    let limits = Limits::new(Some(87.0), Some(STEP_MAX / T), T).unwrap();
    JointGains::from_positions(&design).unwrap().with_limits(limits)
}

/// Load of the arm at a position: gravity \[N·m\].
fn gravity(q: f64) -> f64 {
    6.0 * (q - 0.4).cos()
}

/// A joint under gravity behind one sample of delay; the sensor is exact.
struct Bench {
    arm: Supervisor<f64, 1>,
    state: SupervisorState<f64, 1>,
    /// Load that acts, as a function of the position \[N·m\].
    load: fn(f64) -> f64,
    q: f64,
    dq: f64,
    coming: VecDeque<f64>,
    acted: f64,
    k: u64,
    /// Of the last sample that arrived.
    stamp: Stamp,
    last: f64,
    largest_step: f64,
    braked: bool,
}

impl Bench {
    fn new(joint: JointOptions<f64>, load: fn(f64) -> f64) -> Self {
        let options = Options::new(T_NS);
        let held = load(0.2);
        Self {
            arm: Supervisor::new([gains(0.93, 0.4, 1)], &[joint], &options).unwrap(),
            state: SupervisorState::new(),
            load,
            q: 0.2,
            dq: 0.0,
            coming: VecDeque::from([held]),
            acted: held,
            k: 0,
            stamp: Stamp::default(),
            last: held,
            largest_step: 0.0,
            braked: true,
        }
    }

    /// One period; `heard`: whether its sample arrives.
    fn step(
        &mut self,
        mode: ModeRequest,
        reference: Reference<f64>,
        fed: Option<&[f64]>,
        heard: bool,
    ) -> Answer<f64, 1> {
        let t_ns = self.k * T_NS;
        let joints = [Measurement { q: self.q, dq: self.dq, tau_applied: self.acted }];
        if heard {
            self.stamp = Stamp { sequence: self.k, t_ns };
        }
        let stamp = self.stamp;
        let sample = Sample { stamp, now_ns: t_ns, joints: &joints };
        let preset = [(self.load)(0.2)];
        let references = [reference];
        let request =
            Request { mode, references: &references, preset: Some(&preset), feed_forward: fed };
        let answer = self.arm.step(&mut self.state, &sample, &request);
        let Command { tau, phi_hat, .. } = answer.commands[0];
        assert!(same(phi_hat, self.state.joints[0].phi_hat()), "memory and command say the same");
        if self.k > 150 {
            self.largest_step = self.largest_step.max((tau - self.last).abs());
        }
        self.last = tau;
        self.coming.push_back(tau);
        self.acted = self.coming.pop_front().unwrap();
        self.braked = matches!(answer.report.mode, Mode::Idle | Mode::Armed);
        if !self.braked {
            let ddq = (self.acted - (self.load)(self.q)) / INERTIA;
            self.q += T * (self.dq + 0.5 * T * ddq);
            self.dq += T * ddq;
        }
        self.k += 1;
        answer
    }

    /// Arms with the brakes closed, and holds for so many samples.
    fn hold(&mut self, samples: u64, fed: Option<&[f64]>) {
        let here = Reference { q: self.q, ..Reference::default() };
        for _ in 0..200 {
            self.step(ModeRequest::Arm, here, fed, true);
        }
        for _ in 0..samples {
            self.step(ModeRequest::Hold, here, fed, true);
        }
    }
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits()
}

fn swing(k: u64) -> Reference<f64> {
    let (s, c) = (3.0 * k as f64 * T).sin_cos();
    Reference { q: 0.2 + 0.1 * s, dq: 0.3 * c, ddq: -0.9 * s }
}

fn constant(_q: f64) -> f64 {
    6.0
}

/// Everything a caller does in a day, with a feed-forward `fed(k)`; torques, and estimates of the whole.
fn day(fed: impl Fn(u64) -> Option<f64>) -> (Vec<f64>, Vec<f64>) {
    let mut bench = Bench::new(JointOptions::default(), constant);
    let (mut tau, mut phi) = (Vec::new(), Vec::new());
    for k in 0..6000_u64 {
        let mode = match k {
            0..200 => ModeRequest::Arm,
            200..1000 | 3000..3800 => ModeRequest::Hold,
            1000..3000 | 3800..5000 => ModeRequest::Track,
            _ => ModeRequest::Stop,
        };
        // One to nine in a row are lost: held, and faded.
        let heard = !(2000..2500).contains(&k) || k % 60 > k / 60 % 10;
        let given = fed(k).map(|fed| [fed]);
        let reference = if k < 1000 { swing(0) } else { swing(k - 1000) };
        let answer = bench.step(mode, reference, given.as_ref().map(|g| &g[..]), heard);
        assert!(answer.report.fault.is_none(), "{k}: {:?}", answer.report);
        tau.push(answer.commands[0].tau);
        phi.push(answer.commands[0].phi_hat);
    }
    (tau, phi)
}

#[test]
fn a_constant_however_wrong_changes_nothing() {
    let (plain, plain_phi) = day(|_| None);
    let right = |_| Some(6.0);
    let less = |_| Some(4.8);
    let absurd = |_| Some(-1e6);
    let comes = |k| (k > 1500).then_some(50.0);
    let flickers = |k: u64| (k % 3 > 0).then_some(50.0);
    let leaves = |k: u64| (k < 2300).then_some(-80.0);
    let all: [&dyn Fn(u64) -> Option<f64>; 6] =
        [&right, &less, &absurd, &comes, &flickers, &leaves];
    for (i, fed) in all.iter().enumerate() {
        let (tau, phi) = day(fed);
        let off =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let (in_tau, in_phi) = (off(&tau, &plain), off(&phi, &plain_phi));
        println!("{i}: {in_tau:.1e} N·m in torque, {in_phi:.1e} N·m in what holds");
        // Rounding, of a million for the absurd one.
        let most = if i == 2 { 1e-3 } else { 1e-9 };
        assert!(in_tau < most && in_phi < most, "{i}: {in_tau} {in_phi}");
    }
}

#[test]
fn what_is_known_is_not_estimated() {
    // Along the motion, gravity fed forward as it is, 20 % too small, or not.
    let run = |scale: f64| {
        let mut bench = Bench::new(JointOptions::default(), gravity);
        let fed = |q: f64| [scale * gravity(q)];
        bench.hold(300, Some(&fed(0.2)));
        let (mut estimated, mut worst) = (0.0_f64, 0.0_f64);
        for k in 0..6000 {
            let wanted = swing(k);
            let answer = bench.step(ModeRequest::Track, wanted, Some(&fed(wanted.q)), true);
            assert_eq!(answer.report.mode, Mode::Tracking);
            if k > 2000 {
                let memory = &bench.state.joints[0];
                assert!(same(memory.feed_forward(), fed(wanted.q)[0]));
                estimated = estimated.max((memory.phi_hat() - memory.feed_forward()).abs());
                worst = worst.max((bench.q - swing(k + 1).q).abs());
            }
        }
        // It ends: φ̂ has all of it, and the torque goes on.
        let whole = bench.state.joints[0].phi_hat();
        bench.step(ModeRequest::Track, swing(6000), None, true);
        let memory = &bench.state.joints[0];
        assert!(same(memory.feed_forward(), 0.0));
        assert!((memory.phi_hat() - whole).abs() < 0.02, "{whole}");
        assert!(bench.largest_step < 0.1, "{scale}: {} N·m", bench.largest_step);
        println!("{scale}: φ̂ up to {estimated:.3} N·m, within {worst:.1e} rad");
        (estimated, worst)
    };
    let (nothing, right, less) = (run(0.0), run(1.0), run(0.8));
    // φ̂ + τ_ff is φ: what is fed is missing from φ̂, to what a sample and a delay make of it.
    assert!(right.0 < 0.02, "{right:?}");
    assert!((less.0 - 0.2 * nothing.0).abs() < 0.02 && nothing.0 > 5.5, "{less:?} {nothing:?}");
    assert!(
        right.1 < 0.5 * nothing.1 && less.1 < 0.6 * nothing.1,
        "{right:?} {less:?} {nothing:?}"
    );
}

#[test]
fn lost_samples_fade_to_the_whole() {
    let options = JointOptions::default();
    let mut bench = Bench::new(options, gravity);
    bench.hold(2000, Some(&[gravity(0.2)]));
    let at = Reference { q: 0.2, ..Reference::default() };
    // A push that the feedback answers, then silence.
    bench.dq = 0.2;
    for _ in 0..5 {
        bench.step(ModeRequest::Hold, at, Some(&[gravity(0.2)]), true);
    }
    let whole = bench.state.joints[0].phi_hat();
    let feedback = bench.last - whole;
    assert!(feedback.abs() > 0.2 && (whole - gravity(0.2)).abs() < 3.0, "{feedback} {whole}");
    let asked = [[3.0], [f64::NAN], [80.0]];
    for (missed, fed) in (1..=15_i32).zip(asked.iter().cycle()) {
        // Whatever is asked meanwhile.
        let fed = (missed % 4 > 0).then_some(&fed[..]);
        let answer = bench.step(ModeRequest::Hold, at, fed, false);
        let left = if missed > 5 { 0.8_f64.powi(missed - 5) } else { 1.0 };
        let Command { tau, phi_hat, .. } = answer.commands[0];
        assert!((tau - whole - left * feedback).abs() < 1e-12, "{missed}: {tau}");
        assert!((phi_hat - whole).abs() < 1e-12, "{missed}: {phi_hat}");
    }
}

#[test]
fn a_stop_holds_the_whole() {
    for fed in [None, Some(4.8), Some(-500.0)] {
        let mut bench = Bench::new(JointOptions::default(), gravity);
        let given = fed.map(|fed| [fed]);
        let given = given.as_ref().map(|g| &g[..]);
        bench.hold(1000, given);
        let at = Reference { q: 0.2, ..Reference::default() };
        for k in 0..2000 {
            // The feed-forward ends with the motion, or does not.
            let given = given.filter(|_| k % 2 > 0);
            let answer = bench.step(ModeRequest::Stop, at, given, true);
            let Command { tau, phi_hat, .. } = answer.commands[0];
            assert_eq!(answer.report.mode, Mode::SafeStop);
            assert!((phi_hat - gravity(0.2)).abs() < 1e-6, "{fed:?}: {phi_hat}");
            assert!((tau - gravity(0.2)).abs() < 1e-2, "{fed:?}: {tau}");
        }
        assert!((bench.q - 0.2).abs() < 1e-4, "{}", bench.q);
        // And on again, from what holds it.
        let answers = [(ModeRequest::Arm, 1), (ModeRequest::Hold, 500)];
        for (mode, samples) in answers {
            for _ in 0..samples {
                let answer = bench.step(mode, at, given, true);
                assert!(answer.report.refusal.is_none());
            }
        }
        assert!(bench.largest_step < 1e-2, "{fed:?}: {}", bench.largest_step);
    }
}

/// A feed-forward has just begun or ended where the arm is stopped, by faults that `φ̂` may contain and by
/// others, and then nothing is measured any more: the torque that holds it is the load that was there all the
/// time.
#[test]
fn what_was_known_before_a_stop_is_the_whole_whenever_a_feed_forward_comes_or_goes() {
    for (before, after) in
        [(None, Some(4.8)), (None, Some(-50.0)), (Some(4.8), None), (Some(-50.0), None)]
    {
        for pushed in [false, true] {
            let joint = JointOptions { error_stop: Some(0.05), ..JointOptions::default() };
            let mut bench = Bench::new(joint, constant);
            let [before, after] = [before, after].map(|fed: Option<f64>| fed.map(|fed| [fed]));
            bench.hold(1500, before.as_ref().map(|fed| &fed[..]));
            let after = after.as_ref().map(|fed| &fed[..]);
            let at = Reference { q: 0.2, ..Reference::default() };
            bench.step(ModeRequest::Hold, at, after, true);
            if pushed {
                bench.q += 0.06;
                let answer = bench.step(ModeRequest::Hold, at, after, true);
                assert_eq!(answer.report.fault, Some((Fault::TrackingError, 0)));
            }
            let mut held = f64::NAN;
            for _ in 0..60 {
                held = bench.step(ModeRequest::Hold, at, after, false).commands[0].phi_hat;
            }
            assert_eq!(bench.state.arm.mode(), Mode::SafeStop);
            assert!((held - 6.0).abs() < 1e-6, "{before:?} {after:?} {pushed}: {held}");
        }
    }
}

/// In a soft zone what is estimated and what is fed do not grow outward together, though what is fed does.
#[test]
fn at_the_end_of_its_range_the_whole_does_not_grow_outward() {
    let range = Some(JointRange { lower: -1.0, upper: 0.23, soft: 0.05, braking: 5.0 });
    let joint = JointOptions { range, ..JointOptions::default() };
    let mut bench = Bench::new(joint, constant);
    let mut fed = 5.0;
    bench.hold(50, Some(&[fed]));
    let at = Reference { q: 0.2, ..Reference::default() };
    let whole = bench.state.joints[0].phi_hat();
    let mut estimated = Vec::new();
    for k in 0..100 {
        // It stands, though more and more torque acts outward.
        (bench.q, bench.dq) = (0.2, 0.0);
        bench.acted = 6.0 + 0.1 * f64::from(k);
        fed += 0.02;
        bench.step(ModeRequest::Hold, at, Some(&[fed]), true);
        let memory = &bench.state.joints[0];
        assert!(memory.phi_hat() < whole + 1e-9, "{k}: {} from {whole}", memory.phi_hat());
        assert!(memory.phi_hat() > whole - 1e-3, "{k}: {} from {whole}", memory.phi_hat());
        estimated.push(memory.phi_hat() - memory.feed_forward());
    }
    assert!(estimated[99] < estimated[0] - 1.5, "what is fed is missing from it");
}

#[test]
fn a_shaken_arm_holds_the_mean_of_the_whole() {
    let joint = JointOptions { oscillation: Some(0.5), ..JointOptions::default() };
    let mut bench = Bench::new(joint, constant);
    bench.hold(1000, Some(&[-40.0]));
    let at = Reference { q: 0.2, ..Reference::default() };
    let mut stopped = None;
    for k in 0..200 {
        // Shaken by its encoder, at half of the sample rate.
        let q = bench.q;
        bench.q += if k % 2 == 0 { 2e-3 } else { -2e-3 };
        let answer = bench.step(ModeRequest::Hold, at, Some(&[-40.0]), true);
        bench.q = q;
        if answer.report.fault.is_some() {
            stopped = Some(answer);
            break;
        }
    }
    let stopped = stopped.unwrap();
    assert_eq!(stopped.report.fault, Some((Fault::Oscillation, 0)));
    let held = stopped.commands[0].phi_hat;
    assert!((held - 6.0).abs() < 3.0, "{held}");
}

#[test]
fn what_is_not_finite_is_refused_and_the_last_one_held() {
    for bad in [&[f64::NAN][..], &[f64::INFINITY], &[1e10], &[], &[1.0, 2.0]] {
        let mut bench = Bench::new(JointOptions::default(), gravity);
        bench.hold(1000, Some(&[5.0]));
        let at = Reference { q: 0.2, ..Reference::default() };
        for k in 0..200 {
            let answer = bench.step(ModeRequest::Hold, at, Some(bad), true);
            assert!(answer.report.events.contains(Events::REFERENCE_REFUSED), "{bad:?}");
            assert_eq!(answer.report.mode, Mode::Holding);
            assert!(same(bench.state.joints[0].feed_forward(), 5.0), "{bad:?} {k}");
        }
        assert!(bench.largest_step < 1e-2, "{bad:?}: {}", bench.largest_step);
        // The motion goes on, for as long as a reference may be refused.
        let good = bench.step(ModeRequest::Track, swing(0), Some(&[5.0]), true);
        assert!(good.report.events.is_empty() && good.report.mode == Mode::Tracking);
        for k in 1..20 {
            let answer = bench.step(ModeRequest::Track, swing(k), Some(bad), true);
            assert_eq!(answer.report.mode, Mode::Tracking, "{bad:?} {k}");
        }
        assert!((bench.state.joints[0].reference().dq) > 0.0, "the reference is heeded");
        bench.step(ModeRequest::Track, swing(20), Some(bad), true);
        let answer = bench.step(ModeRequest::Track, swing(21), Some(bad), true);
        assert_eq!(answer.report.fault, Some((Fault::BadReference, 0)), "{bad:?}");
        // From the beginning there is nothing to hold: as without it.
        let mut bench = Bench::new(JointOptions::default(), gravity);
        bench.hold(10, Some(bad));
        assert!(same(bench.state.joints[0].feed_forward(), 0.0));
    }
}

#[test]
fn other_forms_take_no_notice_and_gains_change_across_forms() {
    for form in [Form::Observer, Form::Literal] {
        let design =
            JointDesign { inertia: INERTIA, kp: 400.0, kd: 40.0, a: &[70.0], period: T, form };
        let limits = Limits::new(Some(87.0), Some(STEP_MAX / T), T).unwrap();
        let other = JointGains::new(&design).unwrap().with_limits(limits);
        let mut torques = [None, Some([33.0])].map(|fed| {
            let mut bench = Bench::new(JointOptions::default(), constant);
            bench.arm =
                Supervisor::new([other], &[JointOptions::default()], &Options::new(T_NS)).unwrap();
            bench.hold(500, fed.as_ref().map(|f| &f[..]));
            for k in 0..500 {
                bench.step(ModeRequest::Track, swing(k), fed.as_ref().map(|f| &f[..]), true);
            }
            (bench.last.to_bits(), bench)
        });
        assert_eq!(torques[0].0, torques[1].0, "{form:?}");
        let bench = &mut torques[1].1;
        let here = Reference { q: bench.state.joints[0].reference().q, ..Reference::default() };
        for next in [gains(0.93, 0.4, 1), other, gains(0.95, 0.3, 1), gains(0.9, 0.5, 1), other] {
            for k in 0..2000 {
                bench.step(ModeRequest::Hold, here, Some(&[33.0]), true);
                if k == 1000 {
                    bench.largest_step = 0.0;
                }
            }
            bench.arm.change_gains(&mut bench.state, [next]).unwrap();
            for _ in 0..1000 {
                bench.step(ModeRequest::Hold, here, Some(&[33.0]), true);
            }
            let fed = if next.form() == Form::Positions { 33.0 } else { 0.0 };
            assert!(same(bench.state.joints[0].feed_forward(), fed));
            assert!(bench.largest_step < 0.1, "{form:?}: {}", bench.largest_step);
        }
    }
}

#[test]
fn near_the_end_of_its_range_the_whole_does_not_grow_outward() {
    // In the soft zone with gravity outward, which is fed forward at once and too strongly: φ̂ alone would
    // have to grow outward.
    let range = JointRange { lower: -1.0, upper: 0.22, soft: 0.1, braking: 5.0 };
    let joint = JointOptions { range: Some(range), ..JointOptions::default() };
    let ends = [0.0, -9.0].map(|most| {
        let mut bench = Bench::new(joint, |_| -6.0);
        bench.q = 0.19;
        bench.hold(500, None);
        let at = Reference { q: 0.19, ..Reference::default() };
        for k in 0..3000 {
            // It creeps in over a second.
            let fed = [most * (f64::from(k) * T).min(1.0)];
            let answer = bench.step(ModeRequest::Hold, at, Some(&fed), true);
            assert!(answer.report.fault.is_none());
        }
        println!("{most}: {:.6} rad, {:.3}", bench.q, bench.state.joints[0].phi_hat());
        [bench.q - 0.19, bench.state.joints[0].phi_hat() + 6.0].map(f64::abs)
    });
    // 9 N·m too many would be 28 mrad.
    assert!(ends[0][0] < 1e-4 && ends[1][0] < 1e-3, "{ends:?}");
    assert!(ends[1][1] < 0.3, "{ends:?}");
}

#[test]
fn a_schedule_waits_for_what_is_left_of_the_whole() {
    // Start gains are given up where the mean mismatch φ − φ̂ is below 1 N·m: with a feed-forward of 40 N·m
    // it would never be, were φ̂ not the whole.
    let joint = JointOptions { start: Some(gains(0.96, 0.3, 1)), ..JointOptions::default() };
    let mut bench = Bench::new(joint, constant);
    let mut raised = None;
    bench.hold(0, Some(&[40.0]));
    let at = Reference { q: 0.2, ..Reference::default() };
    for k in 0..2000 {
        let answer = bench.step(ModeRequest::Hold, at, Some(&[40.0]), true);
        if answer.report.events.contains(Events::RAISED) {
            raised = raised.or(Some(k));
        }
        assert!(!answer.report.events.contains(Events::LOWERED));
    }
    assert!(raised.is_some_and(|k| k < 300), "{raised:?}");
    assert!(bench.largest_step < 0.1, "{}", bench.largest_step);
}

/// A drawn day: modes, lost samples, joint options; with one feed-forward that comes, goes, is refused, or
/// with one that jumps.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fed {
    Never,
    /// Never, and the arm stands a picoradian further on: what the arm makes of rounding by itself.
    Shifted,
    OneValue,
    Anything,
}

/// Torques of a drawn day, and the feed-forwards that were in force.
fn drawn(seed: u64, kind: Fed) -> Vec<(f64, f64)> {
    let mut dice = Dice(seed);
    let mut own = Dice(!seed);
    let pick = |dice: &mut Dice, most: u32| {
        let bits = u32::try_from(dice.bits() >> 32);
        bits.map_or(0, |bits| bits % most)
    };
    let mut joint = JointOptions::default();
    if pick(&mut dice, 2) == 0 {
        joint.range = Some(JointRange { lower: -0.4, upper: 0.28, soft: 0.05, braking: 5.0 });
    }
    if pick(&mut dice, 2) == 0 {
        joint.motion = Some(MotionLimits { velocity: 1.0, acceleration: 5.0, jerk: 200.0 });
    }
    if pick(&mut dice, 3) == 0 {
        joint.start = Some(gains(0.95, 0.3, 1));
    }
    if pick(&mut dice, 4) == 0 {
        joint.funnel = Some(Funnel { initial: 0.1, r#final: 0.02, decay_s: 0.1 });
    }
    if pick(&mut dice, 4) == 0 {
        joint.dead_zone = Some(1e-4);
    }
    let mut bench = Bench::new(joint, gravity);
    bench.q += if kind == Fed::Shifted { 1e-12 } else { 0.0 };
    let (mut mode, mut fed, mut lost) = (ModeRequest::Arm, None, 0);
    let value = own.within(-100.0, 100.0);
    let mut torques = Vec::new();
    for k in 0..4000_u64 {
        if k > 200 && pick(&mut dice, 150) == 0 {
            let all = [ModeRequest::Arm, ModeRequest::Hold, ModeRequest::Track, ModeRequest::Stop];
            mode = all[pick(&mut dice, 4) as usize];
        } else if k > 100 && pick(&mut dice, 20) == 0 {
            mode = match bench.state.arm.mode() {
                Mode::Idle | Mode::SafeStop => ModeRequest::Arm,
                Mode::Armed => ModeRequest::Hold,
                Mode::Holding | Mode::Tracking => mode,
            };
        }
        if pick(&mut dice, 60) == 0 {
            lost = pick(&mut dice, 9);
        }
        if pick(&mut own, 20) == 0 {
            let any = [None, Some(value), Some(f64::NAN), Some(own.within(-100.0, 100.0))];
            let most = if kind == Fed::Anything { 4 } else { 2 };
            fed = any[pick(&mut own, most) as usize]
                .filter(|_| matches!(kind, Fed::OneValue | Fed::Anything));
        }
        // A request is refused with what is fed, and too many of them stop the arm: only where nothing is compared.
        let given = fed.map(|fed| [fed]);
        let answer = bench.step(mode, swing(k), given.as_ref().map(|g| &g[..]), lost == 0);
        if answer.report.events.contains(Events::HELD_BACK) {
            // Whether a stop holds a torque back at a sample is decided by what rounding leaves.
            break;
        }
        lost = lost.saturating_sub(1);
        assert!(bench.q.is_finite() && bench.last.is_finite(), "{seed} at {k}");
        if bench.braked {
            bench.dq = 0.0;
        }
        torques.push((bench.last, bench.state.joints[0].feed_forward()));
    }
    torques
}

#[test]
fn whenever_a_constant_comes_and_goes_nothing_changes() {
    let (mut worst, mut fed, mut samples) = (0.0_f64, 0, 0);
    for seed in 0..300 {
        let [with, without, shifted] =
            [Fed::OneValue, Fed::Never, Fed::Shifted].map(|kind| drawn(seed, kind));
        let mut own = 0.0_f64;
        for (k, ((with, given), (without, _))) in with.iter().zip(&without).enumerate() {
            let off = (with - without).abs();
            let Some((shifted, _)) = shifted.get(k) else { break };
            own = own.max((shifted - without).abs());
            if own > 1e-6 {
                // Here the arm by itself, lost samples and brakes before an end of its range, makes much of rounding.
                break;
            }
            assert!(
                off < 1e-10 + 10.0 * own,
                "{seed} at {k}: {with} for {without}, by itself {own}"
            );
            worst = worst.max(off);
            fed += usize::from(*given != 0.0);
            samples += 1;
        }
    }
    println!("{fed} of {samples} samples with a feed-forward, torque off by {worst:.1e} N·m");
    assert!(fed > 100_000);
}

#[test]
fn whatever_is_fed_stays_within_limits() {
    for seed in 0..100 {
        let all = drawn(seed, Fed::Anything);
        for (k, pair) in all.windows(2).enumerate() {
            let [(before, _), (tau, _)] = pair else { unreachable!() };
            let step = (tau - before).abs();
            assert!(step <= STEP_MAX + 1e-9 && tau.abs() <= 87.0, "{seed} at {k}: {step} {tau}");
        }
    }
}
