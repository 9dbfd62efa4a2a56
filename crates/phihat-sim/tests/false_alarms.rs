//! Default monitors of `[supervisor]`, on arms with which nothing is wrong. Wrong if one of them stops an
//! arm.
//!
//! A million samples with `PHIHAT_ALL=1`: encoders, filters, loads, friction, lost samples and jitter as
//! laboratories have them.

use std::fs;
use std::path::Path;

use crate::support::ARMS;
use phihat::{Form, JointDesign, JointGains, Mode};
use phihat_model::{Body, Robot, Workspace};
use phihat_sim::{Motion, Simulation, SimulationOutcome};
use phihat_study::{LawRequest, Study};

fn gains(
    inertia: &[f64],
    (bandwidth, estimator): (f64, f64),
    order: usize,
    (rate, form): (f64, Form),
) -> Vec<JointGains<f64>> {
    let (first, second) = ([estimator], [estimator * estimator, 2.0 * estimator]);
    let a: &[f64] = if order == 1 { &first } else { &second };
    let joint = |inertia: &f64| {
        let (kp, kd) = (bandwidth * bandwidth, 2.0 * bandwidth);
        JointGains::new(&JointDesign { inertia: *inertia, kp, kd, a, period: 1.0 / rate, form })
            .unwrap()
    };
    inertia.iter().map(joint).collect()
}

/// Asserts that no stop occurred and that the arm tracks at the end; returns the number of samples.
fn followed(outcome: &SimulationOutcome, told: &str) -> usize {
    let supervision = outcome.trace.supervision.as_ref().unwrap();
    let stop = supervision.mode.iter().position(|mode| *mode == Mode::SafeStop);
    let fault = stop.map(|at| (at, supervision.fault[at]));
    assert!(fault.is_none(), "{fault:?}: {told}");
    assert_eq!(supervision.mode.last(), Some(&Mode::Tracking), "{told}");
    supervision.mode.len()
}

#[test]
fn f34_nothing_stops_an_arm_with_which_nothing_is_wrong() {
    let all = if std::env::var_os("PHIHAT_ALL").is_some() { 1_000_000 } else { 60_000 };
    let (mut samples, mut round) = (0, 0_usize);
    while samples < all {
        let (name, rate, inertia, bandwidth, estimator) = ARMS[round % 4];
        let robot = Robot::named(name).unwrap();
        let variant = round / 4;
        let order = 1 + variant % 2;
        let (form, word) =
            [(Form::Observer, "observer"), (Form::Literal, "literal")][variant / 2 % 2];
        let bits = [18, 20, 22][variant % 3];
        let filter = if bits == 18 { "velocity_filter_hz = 60.0\n" } else { "" };
        let load = 0.2 + 0.3 * f64::from(u8::try_from(variant % 4).unwrap());
        let body = Body { mass: load, com: [0.0; 3], inertia: [0.0; 6] };
        let model = robot.plant_model().with_payload_on(&robot.tip, &body).unwrap();
        let mut preset = vec![0.0; inertia.len()];
        model.gravity_torque(&mut Workspace::new(&model), &robot.poses["ready"], &mut preset);
        let network = if variant % 2 == 1 { "[world.network]\nsample_loss = 0.01\n" } else { "" };
        let amplitude = [0.1, 0.3][variant % 2];
        let text = format!(
            "duration_s = 5.0\nseed = {round}\n[robot]\nname = \"{name}\"\n[spec]\nsettle_s = 1.0\n[gains]\norder = \
             {order}\nbandwidth_rad_s = {bandwidth:?}\nestimator_bandwidth_rad_s = {estimator:?}\ninertia_kg_m2 = \
             {inertia:?}\n[loop]\nrate_hz = {rate:?}\ndelay_samples = 1\nform = \"{word}\"\n[sensor]\nencoder_bits = \
             {bits}\nvelocity = \"differenced\"\n{filter}[world]\nsubsteps = 4\nfriction = \"robot\"\npayload = {{ \
             mass_kg = {load:?} }}\n{network}[supervisor]\npreset_nm = {preset:?}\n[reference]\nkind = \
             \"sines\"\ncenter = \"ready\"\nfade_in_s = 1.0\n[[reference.sine]]\namplitude_rad = \
             {amplitude:?}\nfrequency_hz = 0.3\n"
        );
        let study = crate::support::read(&text);
        let laws = gains(inertia, (bandwidth, estimator), order, (rate, form));
        samples += followed(&Simulation::new(&study, &laws).unwrap().run(|_| ()), &text);
        round += 1;
    }
    println!("{samples} samples of {round} runs, no stop");
}

/// Sets the torque that holds the arm before the law does, as a user who arms it would state it.
fn hold_at_the_start(study: &mut Study) {
    let motion = Motion::of(study).unwrap();
    let n = study.robot.joints.len();
    let q: Vec<f64> = (0..n).map(|i| motion.at(i, 0.0)[0]).collect();
    let model = study.robot.plant_model().with_gravity(study.world.gravity);
    let mut preset = vec![0.0; n];
    if !study.interface.profile.adds_gravity {
        model.gravity_torque(&mut Workspace::new(&model), &q, &mut preset);
    }
    if let Some(supervisor) = &mut study.supervisor {
        supervisor.preset.get_or_insert(preset);
    }
}

/// Every shipped study that states its gains and that nothing is wrong with, under a supervisor at its defaults.
#[test]
fn f34_nor_does_it_in_a_shipped_study() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    // About drives that saturate, die or err, sensors that freeze, and stops: a supervisor is there to stop these.
    let about_faults =
        ["saturation_step", "sensor_freeze", "weak_drive", "estop_restart", "stiction"];
    let mut seen = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if path.extension().is_none_or(|e| e != "toml") || about_faults.contains(&name.as_str()) {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let supervisor = if text.contains("[supervisor]") { "" } else { "\n[supervisor]\n" };
        let Ok(mut study) = Study::from_text(&format!("{text}{supervisor}"), &name, &folder) else {
            continue;
        };
        let Some(LawRequest::Bandwidths { .. }) = study.gains.as_ref().map(|gains| &gains.law)
        else {
            continue;
        };
        if study.control.form == Form::Positions {
            continue;
        }
        phihat_sim::derive_substeps(&mut study);
        hold_at_the_start(&mut study);
        let rate = 1e9 / study.control.period_ns as f64;
        let own = study.gains.as_ref().unwrap();
        let order = if rate < 600.0 || name == "first" { 1 } else { 2 };
        let bandwidths = if rate < 600.0 { (12.0, 40.0) } else { (20.0, 50.0) };
        let laws = gains(&own.inertia, bandwidths, order, (rate, study.control.form));
        followed(&Simulation::new(&study, &laws).unwrap().run(|_| ()), &name);
        seen += 1;
    }
    assert!(seen >= 5, "{seen} studies");
}
