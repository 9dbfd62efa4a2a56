//! Coupled gains against the nonlinear simulator: a push on joint 2 of the Panda moves joint 4. Wrong if it
//! moved it further than Γ of that posture says, or if a push matched to the response came nowhere near it.

use std::fmt::Write;
use std::path::Path;

use phihat::Form;
use phihat_design::coupled::Postures;
use phihat_design::prelude::*;
use phihat_design::sampled::LoopModel;
use phihat_design::{CoupledGains, requested_gains};
use phihat_sim::Simulation;
use phihat_study::Study;

/// When pushes begin, and how long the response is looked at \[samples\].
const FROM: usize = 100;
const LONG: usize = 1200;

/// Joints 2 and 4.
const PUSHED: usize = 1;
const MOVED: usize = 3;

/// A torque on joint 2 from one sample to another.
type Push = (f64, usize, usize);

/// The Panda of `studies/panda_hand.toml`, held at rest without gravity, friction and encoder, with some pushes.
fn study(pushes: &[Push]) -> Study {
    let mut text = "duration_s = 1.5\n[robot]\nname = \"panda\"\n[gains]\norder = 2\nbandwidth_rad_s = 20.0\n\
        damping = 1.0\nestimator_bandwidth_rad_s = 50.0\nestimator_damping = 1.0\n\
        inertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]\n[spec]\nsettle_s = 0.001\n[loop]\n\
        rate_hz = 1000.0\ndelay_samples = 1\ntorque_max_nm = \"none\"\n[sensor]\nvelocity = \"differenced\"\n\
        velocity_filter_hz = 45.0\n[reference]\nkind = \"hold\"\nq_rad = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, \
        0.785]\n[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\nfriction = \"none\"\n"
        .to_owned();
    for (torque, from, to) in pushes {
        let (start, duration) = (*from as f64 * 1e-3 - 1e-6, (to - from) as f64 * 1e-3);
        let _ = write!(
            text,
            "[[world.push]]\njoint = \"panda_joint2\"\ntorque_nm = {torque:.3}\nstart_s = {start:.6}\nduration_s = \
                {duration:.6}\n"
        );
    }
    Study::from_text(&text, "panda.toml", Path::new(".")).unwrap()
}

/// Joint 4's error at every sample.
fn moved(pushes: &[Push]) -> Vec<f64> {
    let study = study(pushes);
    let names = study.robot.joint_names();
    let gains = requested_gains(&study).unwrap();
    let law = gains.joint_gains(&names, study.control.period_ns, Form::Observer).unwrap();
    let outcome = Simulation::new(&study, &law).unwrap().run(|_| ());
    assert!(outcome.divergence.is_none());
    let joint = &outcome.trace.joints[MOVED];
    joint.q.iter().zip(&joint.q_desired).map(|(q, desired)| q - desired).collect()
}

/// Γ at that posture \[rad/(N·m)\].
fn gamma() -> f64 {
    let study = study(&[]);
    let gains = requested_gains(&study).unwrap();
    let models: Vec<LoopModel> = (0..7).map(|i| LoopModel::from_study(&study, i)).collect();
    let loops: Vec<_> = gains.joints.iter().zip(&models).collect();
    let q = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];
    let empty = Postures::of(&study).unwrap().at(&q, "ready").remove(0);
    let found = CoupledGains::find(&loops, &[empty], "ready".into()).unwrap();
    found.verify(&loops).unwrap();
    found.error_rad_per_nm[MOVED][PUSHED]
}

fn largest(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |most, e| e.abs().max(most))
}

#[test]
fn a_push_on_joint_2_moves_joint_4_by_what_is_said() {
    let gamma = gamma();
    // 20 N·m, at once and for good.
    let step = largest(&moved(&[(20.0, FROM, FROM + LONG)]));
    println!("20 N·m: {:.3} mrad of {:.3}", step * 1e3, 20.0 * gamma * 1e3);
    assert!(step < 20.0 * gamma);
    // One sample's push shows the response; the signs of it, backwards, are the worst push of 1 N·m.
    let response = moved(&[(1.0, FROM, FROM + 1)]);
    let sign = |k: usize| if response[FROM + LONG - k] < 0.0 { -1.0 } else { 1.0 };
    let mut pushes: Vec<Push> = vec![(sign(0), FROM, FROM + 1)];
    for k in 1..LONG {
        match pushes.last_mut() {
            Some(last) if (last.0 < 0.0) == (sign(k) < 0.0) => last.2 += 1,
            _ => pushes.push((sign(k), FROM + k, FROM + k + 1)),
        }
    }
    let worst = largest(&moved(&pushes));
    println!(
        "matched, {} pieces: {:.4} of Γ = {:.4} mrad",
        pushes.len(),
        worst / gamma,
        gamma * 1e3
    );
    assert!(worst < gamma && worst > 0.95 * gamma);
}
