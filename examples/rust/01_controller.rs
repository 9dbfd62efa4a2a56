//! 01: one joint under control.
//!
//! A pendulum of 2 kg on 0.4 m with dry friction. The controller knows neither mass, length, gravity nor
//! friction: one nominal inertia, a bandwidth, and the torque that acted. The same in C and in Python:
//! examples/c/01_controller.c, examples/python/01_controller.py.
//!
//! Run it: `cargo run -p phihat-examples --example 01_controller`

use std::error::Error;
use std::f64::consts::TAU;

use phihat::{
    Controller, Form, JointDesign, JointGains, JointState, Limits, Measurement, Reference,
};

const T: f64 = 1e-3; // sample period [s]
const MASS: f64 = 2.0;
const LENGTH: f64 = 0.4;
const INERTIA: f64 = MASS * LENGTH * LENGTH; // 0.32 kg·m²

fn main() -> Result<(), Box<dyn Error>> {
    // Gains: bandwidth 20 rad/s, second-order estimator with both poles at 70 rad/s.
    let design = JointDesign {
        inertia: 0.25, // a guess: the true one is 0.32
        kp: 20.0 * 20.0,
        kd: 2.0 * 20.0,
        a: &[70.0 * 70.0, 2.0 * 70.0],
        period: T,
        form: Form::Observer,
    };
    // `new` checks everything once. Wrong gains are an error with the gain's name, never a panic.
    let gains = JointGains::new(&design)?.with_limits(Limits::new(Some(40.0), None, T)?);
    let wrong = JointGains::<f64>::new(&JointDesign { kp: -1.0, ..design });
    println!("refused: {}", wrong.err().ok_or("K_p = -1 should be refused")?);

    // Gains never change; what a joint remembers is yours.
    let controller = Controller::new([gains]);
    let mut state = [JointState::new()];

    let (mut q, mut dq, mut tau) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut worst = 0.0_f64;
    let w = TAU * 0.3;
    for k in 0..10_000 {
        let t = f64::from(k) * T;
        let reference = Reference {
            q: 0.5 * (w * t).sin().powi(2),
            dq: 0.5 * w * (2.0 * w * t).sin(),
            ddq: w * w * (2.0 * w * t).cos(),
        };

        // Every millisecond: what the sensors say, and the torque that acted since the last sample.
        let measurement = Measurement { q, dq, tau_applied: tau };
        let [command] = controller.update(&mut state, &[measurement], &[reference]);
        tau = command.tau;

        if t > 1.0 {
            worst = worst.max((q - reference.q).abs());
        }

        // The pendulum, which the controller does not know.
        let friction = 0.5 * dq / (dq * dq + 1e-4).sqrt();
        let ddq = (tau - friction - MASS * 9.81 * LENGTH * q.sin()) / INERTIA;
        dq += T * ddq;
        q += T * dq;
    }
    println!("largest error after 1 s: {:.2} mrad", 1e3 * worst);
    assert!(worst < 5e-3);

    // A sample that is no number: the last torque is held, nothing is remembered of it, and the status says so.
    let broken = Measurement { q: f64::NAN, dq, tau_applied: tau };
    let [held] = controller.update(&mut state, &[broken], &[Reference::default()]);
    assert!(held.status.refused && held.tau.to_bits() == tau.to_bits());
    println!("not a number: refused, {:.2} N·m held", held.tau);
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn Error>> {
    main()
}
