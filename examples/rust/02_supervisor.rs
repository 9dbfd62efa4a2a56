//! 02: a joint under supervision: armed, held, tracked; then the link to the robot is lost, and comes back.
//!
//! The pendulum of 01_controller.rs. The supervisor judges every sample, starts without a jolt, holds the torque
//! while samples are missing, stops when too many are, and starts again when it is asked to.
//!
//! Run it: `cargo run -p phihat-examples --example 02_supervisor`

use std::error::Error;
use std::f64::consts::TAU;

use phihat::{
    Form, JointDesign, JointGains, JointOptions, JointRange, Limits, Measurement, Mode,
    ModeRequest, Options, Reference, Request, Sample, Stamp, Supervisor, SupervisorState,
};

const T: f64 = 1e-3;
const T_NS: u64 = 1_000_000;
const MASS: f64 = 2.0;
const LENGTH: f64 = 0.4;
const INERTIA: f64 = MASS * LENGTH * LENGTH;
const START: f64 = 0.4;

/// Requests of an operator: arm, hold, track; and after the stop, once the link is back, the same again.
fn wish(k: u64) -> ModeRequest {
    match k {
        0..10 => ModeRequest::Arm,
        10..1000 => ModeRequest::Hold,
        1000..6100 => ModeRequest::Track,
        6100..7000 => ModeRequest::Stop,
        7000..7010 => ModeRequest::Arm,
        7010..8333 => ModeRequest::Hold,
        _ => ModeRequest::Track,
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let design = JointDesign {
        inertia: 0.25,
        kp: 400.0,
        kd: 40.0,
        a: &[4900.0, 140.0],
        period: T,
        form: Form::Observer,
    };
    let gains = JointGains::new(&design)?.with_limits(Limits::new(Some(40.0), Some(1000.0), T)?);
    // What is not stated is not judged.
    let joint = JointOptions {
        velocity_max: Some(4.0),
        range: Some(JointRange { lower: -1.5, upper: 1.5, soft: 0.05, braking: 5.0 }),
        error_stop: Some(0.1),
        ..JointOptions::default()
    };
    let arm = Supervisor::new([gains], &[joint], &Options::new(T_NS))?;
    let mut state = SupervisorState::new();

    let (mut q, mut dq, mut tau) = (START, 0.0_f64, 0.0_f64);
    let (mut seen, mut worst, mut modes) = (0, 0.0_f64, vec![Mode::Idle]);
    let w = TAU * 0.3;
    for k in 0..12_000 {
        let t = 1e-9 * (k * T_NS) as f64;
        let reference = Reference {
            q: START + 0.3 * (w * t).sin().powi(2),
            dq: 0.3 * w * (2.0 * w * t).sin(),
            ddq: 0.6 * w * w * (2.0 * w * t).cos(),
        };
        // The link is lost for half a second: the last sample is repeated, its number too.
        if !(6000..6500).contains(&k) {
            seen = k;
        }
        let joints = [Measurement { q, dq, tau_applied: tau }];
        let stamp = Stamp { sequence: seen, t_ns: seen * T_NS };
        let sample = Sample { stamp, now_ns: k * T_NS, joints: &joints };
        let request =
            Request { mode: wish(k), references: &[reference], preset: None, feed_forward: None };

        // Once per period, whether a new sample came or not.
        let answer = arm.step(&mut state, &sample, &request);
        let ([command], report) = (answer.commands, answer.report);
        tau = command.tau;
        assert!(tau.is_finite() && tau.abs() <= 40.0);

        if modes.last() != Some(&report.mode) {
            let fault = report.fault.map_or("", |(fault, _joint)| fault.name());
            println!("{t:6.3} s  {} {fault}", report.mode.name());
            modes.push(report.mode);
        }
        let settled = k > 10_000 || (2501..6000).contains(&k);
        if report.mode == Mode::Tracking && settled {
            worst = worst.max((q - reference.q).abs());
        }

        // The pendulum, and its brake.
        let friction = 0.5 * dq / (dq * dq + 1e-4).sqrt();
        dq += T * (tau - friction - MASS * 9.81 * LENGTH * q.sin()) / INERTIA;
        if report.brake {
            dq = 0.0;
        }
        q += T * dq;
    }

    println!("largest error while tracking: {:.2} mrad", 1e3 * worst);
    let start = [Mode::Armed, Mode::Holding, Mode::Tracking];
    assert_eq!(modes, [&[Mode::Idle], &start[..], &[Mode::SafeStop], &start[..]].concat());
    assert!(worst < 5e-3);
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn Error>> {
    main()
}
