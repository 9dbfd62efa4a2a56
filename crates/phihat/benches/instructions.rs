//! Program that `cargo xtask test instructions` counts under callgrind: so many samples of one class of
//! input, 7 joints, second order. `CLASS SAMPLES`; run as a test it does each class once.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]
#![allow(clippy::unwrap_used, reason = "a benchmark stops on a bad set-up")]

use std::hint::black_box;

use phihat::{
    Controller, Form, InnovationSection, JointDesign, JointGains, JointOptions, JointRange,
    JointState, Limits, Measurement, ModeRequest, MotionLimits, Options, PositionDesign, Reference,
    Request, Sample, Stamp, Supervisor, SupervisorState,
};

const N: usize = 7;
/// The bare law; that from positions, behind one sample of delay; the same with a filter of two sections on
/// its innovation; guard, limits and modes around it; then with joint ranges and monitors: at rest, moving,
/// with jitter, against its limits, near the end of a joint's range; and with the reference governor.
const CLASSES: [&str; 10] =
    ["law", "seen", "filtered", "plain", "rest", "motion", "jitter", "limits", "range", "shaped"];

fn gains() -> JointGains<f64> {
    let a = &[4900.0, 140.0];
    let design =
        JointDesign { inertia: 0.8, kp: 400.0, kd: 40.0, a, period: 1e-3, form: Form::Observer };
    let limits = Limits::new(Some(87.0), Some(1000.0), 1e-3).unwrap();
    JointGains::new(&design).unwrap().with_limits(limits)
}

/// A slow triangle: no transcendental function among what is counted.
fn triangle(k: u64) -> (f64, f64) {
    let phase = k % 2000;
    if phase < 1000 { (phase as f64 * 2e-4, 0.2) } else { ((2000 - phase) as f64 * 2e-4, -0.2) }
}

/// Measurements and references, made before anything is counted.
type Inputs = Vec<([Measurement<f64>; N], [Reference<f64>; N])>;

fn inputs(class: &str) -> Inputs {
    let one = |k: u64| {
        let (mut q, mut dq) = triangle(k);
        let mut target = Reference { q, dq, ddq: 0.0 };
        match class {
            "rest" => (q, dq, target) = (0.1, 0.0, Reference { q: 0.1, dq: 0.0, ddq: 0.0 }),
            "limits" => target.q = q + if k < 3 { 0.0 } else { 1.0 },
            "range" => (q, target.q) = (q + 0.75, target.q + 0.75),
            "shaped" => target.q = q + if k.is_multiple_of(500) { 0.04 } else { 0.03 },
            _ => {}
        }
        let dq = if k == 0 { 0.0 } else { dq };
        ([Measurement { q, dq, tau_applied: 1.0 }; N], [target; N])
    };
    (0..2000).map(one).collect()
}

fn from_positions() -> JointGains<f64> {
    // Sampled poles at 0.93, 0.94, 0.95 and 0.96.
    let design = PositionDesign {
        inertia: 0.8,
        kp: 400.0,
        kd: 40.0,
        correction: &[0.2028, 15.77, -543.0, -8.4e3],
        velocity_correction: &[],
        share: 0.4,
        delay: 1,
        period: 1e-3,
    };
    let limits = Limits::new(Some(87.0), Some(1000.0), 1e-3).unwrap();
    JointGains::from_positions(&design).unwrap().with_limits(limits)
}

fn filtered() -> JointGains<f64> {
    let section = InnovationSection { rates: [0.02, 0.3], weights: [-200.0, 50.0] };
    from_positions().with_innovation_filter(&[section; 2]).unwrap()
}

fn law(gains: &JointGains<f64>, samples: usize) -> f64 {
    let controller = Controller::new([*gains; N]);
    let mut states = [JointState::new(); N];
    let mut sum = 0.0;
    for (m, r) in inputs("law").iter().cycle().take(samples) {
        sum += controller.update(&mut states, black_box(m), black_box(r))[0].tau;
    }
    sum
}

/// By itself: a result that holds an arm is as large as the arm.
fn supervisor(class: &str) -> Supervisor<f64, N> {
    let motion = MotionLimits { velocity: 2.0, acceleration: 10.0, jerk: 500.0 };
    let plain =
        JointOptions { velocity_max: Some(3.0), error_stop: Some(10.0), ..JointOptions::default() };
    let full = JointOptions {
        velocity_max: Some(3.0),
        error_stop: Some(10.0),
        frozen_travel: Some(1.0),
        oscillation: Some(1e6),
        range: Some(JointRange { lower: -1.0, upper: 1.0, soft: 0.1, braking: 5.0 }),
        motion: (class == "shaped").then_some(motion),
        ..JointOptions::default()
    };
    let joint = if class == "plain" { plain } else { full };
    Supervisor::new([gains(); N], &[joint; N], &Options::new(1_000_000)).unwrap()
}

fn arm(class: &str, samples: usize) -> f64 {
    let arm = supervisor(class);
    let mut state = SupervisorState::new();
    let mut sum = 0.0;
    let mut t_ns = 0;
    for (k, (joints, references)) in inputs(class).iter().cycle().take(samples).enumerate() {
        t_ns += if class == "jitter" { 700_000 + 600_000 * (k as u64 % 2) } else { 1_000_000 };
        let mode = match k {
            0 => ModeRequest::Arm,
            1 => ModeRequest::Hold,
            _ => ModeRequest::Track,
        };
        let stamp = Stamp { sequence: k as u64, t_ns };
        let sample = Sample { stamp, now_ns: t_ns, joints: black_box(joints) };
        let request =
            Request { mode, references: black_box(references), preset: None, feed_forward: None };
        let answer = arm.step(&mut state, &sample, &request);
        assert!(answer.report.fault.is_none(), "{class}: {:?}", answer.report);
        sum += answer.commands[0].tau;
    }
    sum
}

fn run(class: &str, samples: usize) {
    let sum = match class {
        "law" => law(&gains(), samples),
        "seen" => law(&from_positions(), samples),
        "filtered" => law(&filtered(), samples),
        _ => arm(class, samples),
    };
    println!("{class}: {samples} samples, sum of torques {sum:.3} N·m");
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match (arguments.first(), arguments.get(1).and_then(|n| n.parse().ok())) {
        (Some(class), Some(samples)) => run(class, samples),
        _ => CLASSES.iter().for_each(|class| run(class, 3000)),
    }
}
