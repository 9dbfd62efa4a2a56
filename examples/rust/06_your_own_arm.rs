//! 06: your own arm: from a URDF's text to a nominal inertia, an inertia window and a closed loop of your own.
//!
//! No study and no simulator of ours: this shows the parts, for those who have a simulator already.
//!
//! Run it: `cargo run -p phihat-examples --example 06_your_own_arm`

use std::error::Error;

use phihat::{
    Controller, Form, JointDesign, JointGains, JointState, Limits, Measurement, Reference,
    TorqueSource, VelocitySource,
};
use phihat_design::JointRecord;
use phihat_design::prelude::*;
use phihat_design::sampled::{InertiaWindow, LoopModel};
use phihat_model::{Body, Robot, Workspace};

/// Two links in the vertical plane.
const URDF: &str = r#"
<robot name="mine">
  <link name="base"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/> <child link="upper"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2.9" upper="2.9" effort="80" velocity="6"/>
  </joint>
  <link name="upper">
    <inertial>
      <origin xyz="0 0 0.2"/> <mass value="3"/>
      <inertia ixx="0.05" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.004"/>
    </inertial>
  </link>
  <joint name="elbow" type="revolute">
    <parent link="upper"/> <child link="lower"/>
    <origin xyz="0 0 0.4"/> <axis xyz="0 1 0"/>
    <limit lower="-2.6" upper="2.6" effort="40" velocity="6"/>
  </joint>
  <link name="lower">
    <inertial>
      <origin xyz="0 0 0.15"/> <mass value="1.5"/>
      <inertia ixx="0.015" ixy="0" ixz="0" iyy="0.015" iyz="0" izz="0.001"/>
    </inertial>
  </link>
</robot>
"#;

/// Data that a URDF cannot contain: the rotors' inertia, reflected to the joint.
const EXTRAS: &str = r#"
name = "mine"
description = "Two links in the vertical plane"
urdf = "mine.urdf"
tip = "lower"
licence = "MIT OR Apache-2.0"
provenance = "Made up for an example."
joints = ["shoulder", "elbow"]

[rotor]
armature_kg_m2 = [0.15, 0.10]
source = "made up"
"#;

const T: f64 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let robot = Robot::from_text(URDF, Some(EXTRAS), "mine.toml")?;
    println!("{}: {}", robot.name, robot.model.joint_names().join(", "));

    // 1. One number per joint: the geometric mean of the range of its inertia over the arm's postures.
    let range = robot.inertia_range(2_000, 1);
    for (joint, mean) in robot.joints.iter().zip(&range.mean) {
        println!("{}: M̄ = {mean:.3} kg·m²", joint.name);
    }
    println!("the arm covers {:.2} to {:.2} times that", range.lambda_min, range.lambda_max);

    // 2. Does the window of these gains hold the arm? The loop is the one that will run: 1 kHz, one sample of
    //    delay, velocity from differences of the position.
    let model = LoopModel {
        period_s: T,
        delay_samples: 1,
        sample_delay_samples: 0,
        torque: TorqueSource::Applied,
        velocity: VelocitySource::Differenced,
        velocity_filter_hz: None,
        torque_filter_hz: None,
        form: Form::Observer,
        drive_bandwidth_hz: None,
    };
    let (kp, kd, a) = (400.0, 40.0, vec![70.0 * 70.0, 2.0 * 70.0]);
    let record = |name: &str, inertia_kg_m2: f64| JointRecord {
        name: name.to_owned(),
        inertia_kg_m2,
        kp_per_s2: kp,
        kd_per_s: kd,
        a: a.clone(),
        observer: None,
    };
    let window = InertiaWindow::find(&record("shoulder", range.mean[0]), &model)?;
    println!("stable from {:.2} to {:.2} times M̄", window.low, window.high);
    window.verify(&record("shoulder", range.mean[0]), &model)?;
    assert!(window.contains(range.lambda_min, range.lambda_max));

    // Twice the bandwidth leaves less room: the window is closed at both ends.
    let mut fast = record("shoulder", range.mean[0]);
    (fast.kp_per_s2, fast.kd_per_s) = (1600.0, 80.0);
    fast.a = vec![140.0 * 140.0, 2.0 * 140.0];
    let narrow = InertiaWindow::find(&fast, &model)?;
    println!("twice as fast: from {:.2} to {:.2} times M̄", narrow.low, narrow.high);
    assert!(narrow.ratio() < window.ratio());

    // 3. The controller, and the loop that is yours: here the arm with 1 kg in its hand, of which nobody told the
    //    controller. `plant_model` has the rotors.
    let joint = |i: usize| -> Result<JointGains<f64>, Box<dyn Error>> {
        let inertia = range.mean[i];
        let design = JointDesign { inertia, kp, kd, a: &a, period: T, form: Form::Observer };
        let limits = Limits::new(robot.joints[i].torque_max, None, T)?;
        Ok(JointGains::new(&design)?.with_limits(limits))
    };
    let controller = Controller::new([joint(0)?, joint(1)?]);
    let mut states = [JointState::new(); 2];
    let kilogram = Body { mass: 1.0, com: [0.0, 0.0, 0.3], inertia: [0.0; 6] };
    let plant = robot.plant_model().with_payload_on(&robot.tip, &kilogram)?;
    let mut ws = Workspace::new(&plant);

    let motion = |t: f64| {
        let sine = |center: f64, amplitude: f64, w: f64| {
            // (1 − cos wt) starts at rest.
            let (s, c) = (w * t).sin_cos();
            Reference {
                q: center + amplitude * (1.0 - c),
                dq: amplitude * w * s,
                ddq: amplitude * w * w * c,
            }
        };
        [sine(0.3, 0.4, 1.5), sine(0.8, 0.3, 2.5)]
    };
    let start = motion(0.0);
    let (mut q, mut dq, mut acted) = ([start[0].q, start[1].q], [0.0; 2], [0.0; 2]);
    let mut last = q;
    let mut on_its_way = [0.0; 2]; // one sample of delay
    let mut worst = [0.0_f64; 2];
    for k in 0..6_000 {
        let t = f64::from(k) * T;
        let references = motion(t);
        let measured =
            |i: usize| Measurement { q: q[i], dq: (q[i] - last[i]) / T, tau_applied: acted[i] };
        let commands = controller.update(&mut states, &[measured(0), measured(1)], &references);
        last = q;
        acted = on_its_way;
        on_its_way = commands.map(|command| command.tau);
        if t > 2.0 {
            for i in 0..2 {
                worst[i] = worst[i].max((q[i] - references[i].q).abs());
            }
        }
        // Ten short steps of the arm.
        let h = T / 10.0;
        for _ in 0..10 {
            let mut ddq = [0.0; 2];
            plant.forward_dynamics(&mut ws, &q, &dq, &acted, &mut ddq);
            for i in 0..2 {
                dq[i] += h * ddq[i];
                q[i] += h * dq[i];
            }
        }
    }
    println!("largest error: {:.2} and {:.2} mrad", 1e3 * worst[0], 1e3 * worst[1]);
    assert!(worst.iter().all(|e| *e < 5e-3));
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn Error>> {
    main()
}
