//! The law from positions under supervision: it engages from a held torque, tracks, bears lost samples and a change of
//! gains, and stops, without a step in torque. Wrong if the supervisor forgot what only this law remembers.
#![allow(clippy::large_types_passed_by_value, reason = "tests: a panic is the report")]

use std::collections::VecDeque;

use phihat::{
    Form, JointDesign, JointGains, JointOptions, JointRange, Limits, Measurement, Mode,
    ModeRequest, OptionError, Options, PositionDesign, Reference, Request, Sample, Stamp,
    Supervisor, SupervisorState,
};

const T: f64 = 1e-3;
const LOAD: f64 = 6.0;

/// Three observer poles at `r`; inertia 1.
fn gains(r: f64, share: f64) -> JointGains<f64> {
    // The fading-memory filter of second degree, in time units of T.
    let (g, h, k) = (1.0 - r * r * r, 1.5 * (1.0 - r * r) * (1.0 - r), 0.5 * (1.0 - r).powi(3));
    let design = PositionDesign {
        inertia: 1.0,
        kp: 400.0,
        kd: 40.0,
        correction: &[g, h / T, -2.0 * k / (T * T)],
        velocity_correction: &[],
        share,
        delay: 1,
        period: T,
    };
    let limits = Limits::new(Some(87.0), Some(1000.0), T).unwrap();
    JointGains::from_positions(&design).unwrap().with_limits(limits)
}

/// A joint behind one sample of delay, with an encoder of 18 bits.
struct Bench {
    arm: Supervisor<f64, 1>,
    state: SupervisorState<f64, 1>,
    q: f64,
    dq: f64,
    coming: VecDeque<f64>,
    acted: f64,
    k: u64,
    largest_step: f64,
    last: f64,
}

impl Bench {
    fn new(joint: JointOptions<f64>) -> Self {
        Self {
            arm: Supervisor::new([gains(0.93, 0.4)], &[joint], &Options::new(1_000_000)).unwrap(),
            state: SupervisorState::new(),
            q: 0.2,
            dq: 0.0,
            coming: VecDeque::from([LOAD]),
            acted: LOAD,
            k: 0,
            largest_step: 0.0,
            last: LOAD,
        }
    }

    /// One period; `heard`: whether its sample arrives.
    fn step(&mut self, mode: ModeRequest, reference: &Reference<f64>, heard: bool) -> Mode {
        let quantum = core::f64::consts::TAU / 262_144.0;
        let q = (self.q / quantum).round() * quantum;
        let t_ns = self.k * 1_000_000;
        let joints = [Measurement { q, dq: self.dq, tau_applied: self.acted }];
        let stamp = if heard {
            Stamp { sequence: self.k, t_ns }
        } else {
            Stamp { sequence: self.k.saturating_sub(1), t_ns: t_ns.saturating_sub(1_000_000) }
        };
        let sample = Sample { stamp, now_ns: t_ns, joints: &joints };
        let preset = [LOAD];
        let request = Request {
            mode,
            references: std::slice::from_ref(reference),
            preset: Some(&preset),
            feed_forward: None,
        };
        let answer = self.arm.step(&mut self.state, &sample, &request);
        let tau = answer.commands[0].tau;
        self.largest_step = self.largest_step.max((tau - self.last).abs());
        self.last = tau;
        self.coming.push_back(tau);
        self.acted = self.coming.pop_front().unwrap();
        let braked = matches!(answer.report.mode, Mode::Idle | Mode::Armed);
        if !braked {
            let ddq = self.acted - LOAD;
            self.q += T * (self.dq + 0.5 * T * ddq);
            self.dq += T * ddq;
        }
        self.k += 1;
        answer.report.mode
    }

    fn engage(&mut self) {
        let here = Reference { q: self.q, ..Reference::default() };
        for _ in 0..200 {
            self.step(ModeRequest::Arm, &here, true);
        }
        self.last = LOAD;
        self.largest_step = 0.0;
        for _ in 0..300 {
            self.step(ModeRequest::Hold, &here, true);
        }
    }
}

fn swing(k: u64) -> Reference<f64> {
    let (s, c) = (3.0 * k as f64 * T).sin_cos();
    Reference { q: 0.2 + 0.1 * s, dq: 0.3 * c, ddq: -0.9 * s }
}

#[test]
fn it_engages_tracks_and_stops_without_a_step() {
    let mut bench = Bench::new(JointOptions::default());
    bench.engage();
    assert!(bench.largest_step < 0.05, "engaging: {} N·m", bench.largest_step);
    assert!((bench.q - 0.2).abs() < 1e-4, "{}", bench.q);
    let mut worst = 0.0_f64;
    for k in 0..4000 {
        let wanted = swing(k);
        assert_eq!(bench.step(ModeRequest::Track, &wanted, true), Mode::Tracking);
        worst = worst.max(if k > 2000 { (bench.q - swing(k + 1).q).abs() } else { 0.0 });
    }
    println!("tracks within {worst:.1e} rad, largest step {:.3} N·m", bench.largest_step);
    assert!(worst < 1e-5 && bench.largest_step < 0.08, "{worst} {}", bench.largest_step);
    for _ in 0..3000 {
        bench.step(ModeRequest::Stop, &Reference::default(), true);
    }
    assert!(bench.dq.abs() < 1e-2, "{}", bench.dq);
}

#[test]
fn lost_samples_are_bridged() {
    let mut bench = Bench::new(JointOptions::default());
    bench.engage();
    let mut worst = 0.0_f64;
    for k in 0..6000_u64 {
        // One to three in a row, every 40 samples.
        let heard = k % 40 > (k / 40) % 3;
        bench.step(ModeRequest::Track, &swing(k), heard);
        worst = worst.max(if k > 2000 { (bench.q - swing(k + 1).q).abs() } else { 0.0 });
    }
    println!("one to three of forty lost: {worst:.1e} rad, {:.3} N·m", bench.largest_step);
    assert!(worst < 2e-5 && bench.largest_step < 0.1, "{worst} {}", bench.largest_step);
}

#[test]
fn gains_change_without_a_step() {
    for (r, share) in [(0.9, 0.6), (0.96, 0.2), (0.93, 0.4)] {
        let mut bench = Bench::new(JointOptions::default());
        bench.engage();
        let here = Reference { q: 0.2, ..Reference::default() };
        bench.largest_step = 0.0;
        bench.arm.change_gains(&mut bench.state, [gains(r, share)]).unwrap();
        for _ in 0..2000 {
            assert_eq!(bench.step(ModeRequest::Hold, &here, true), Mode::Holding);
        }
        println!("{r} {share}: {:.3} N·m", bench.largest_step);
        assert!(bench.largest_step < 0.2, "{r} {share}: {} N·m", bench.largest_step);
        assert!((bench.q - 0.2).abs() < 1e-4);
        // To the torque observer and back: other memories altogether.
        let observer = JointDesign {
            inertia: 1.0,
            kp: 400.0,
            kd: 40.0,
            a: &[70.0],
            period: T,
            form: Form::Observer,
        };
        let limits = Limits::new(Some(87.0), Some(1000.0), T).unwrap();
        let observer = JointGains::new(&observer).unwrap().with_limits(limits);
        for other in [observer, gains(r, share)] {
            bench.largest_step = 0.0;
            bench.arm.change_gains(&mut bench.state, [other]).unwrap();
            for _ in 0..2000 {
                assert_eq!(bench.step(ModeRequest::Hold, &here, true), Mode::Holding);
            }
            assert!(bench.largest_step < 0.2, "{r} {share}: {} N·m", bench.largest_step);
            assert!((bench.q - 0.2).abs() < 1e-4, "{}", bench.q);
        }
    }
}

#[test]
fn a_joint_range_is_kept() {
    let range = JointRange { lower: -0.3, upper: 0.25, soft: 0.05, braking: 5.0 };
    let mut bench = Bench::new(JointOptions { range: Some(range), ..JointOptions::default() });
    bench.engage();
    for k in 0..4000 {
        bench.step(ModeRequest::Track, &swing(k), true);
        assert!(bench.q < 0.25 + 1e-3, "{} at {k}", bench.q);
    }
}

#[test]
fn start_gains_of_another_kind_are_refused() {
    let observer = JointDesign {
        inertia: 1.0,
        kp: 400.0,
        kd: 40.0,
        a: &[70.0],
        period: T,
        form: Form::Observer,
    };
    let start = Some(JointGains::new(&observer).unwrap());
    let joint = JointOptions { start, ..JointOptions::default() };
    let refused = Supervisor::new([gains(0.93, 0.4)], &[joint], &Options::new(1_000_000));
    assert!(matches!(refused, Err(OptionError::Form { joint: 0 })), "{refused:?}");
    let same = JointOptions { start: Some(gains(0.95, 0.3)), ..JointOptions::default() };
    let mut bench = Bench::new(same);
    bench.engage();
    for k in 0..4000 {
        assert_eq!(bench.step(ModeRequest::Track, &swing(k), true), Mode::Tracking);
    }
    assert!((bench.q - swing(4000).q).abs() < 3e-4);
}
