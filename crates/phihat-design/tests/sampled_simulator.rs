//! The loop model of a study is the loop that the simulator runs. Wrong if a setting of the study were read
//! differently here and there, or the simulator's order of events differed by one sample.

use std::path::Path;

use nalgebra::DVector;
use phihat::{Form, VelocitySource};
use phihat_design::prelude::*;
use phihat_design::sampled::{InertiaWindow, LoopModel, StateMatrix};
use phihat_design::{Arm, Certificate, LeftOut, arm_inside_window, requested_gains};
use phihat_sim::Simulation;
use phihat_study::Study;

/// Inertia of the rod about its hinge \[kg·m²\], and the one its gains are told.
const ROD: f64 = 0.52;
const TOLD: f64 = 0.4;

fn study(form: &str, delay: u32, velocity: &str, filter: &str, drive: &str) -> Study {
    let text = format!(
        "duration_s = 0.5\n[robot]\nfile = \"rod.urdf\"\n[gains]\norder = 2\nbandwidth_rad_s = 15.0\n\
         damping = 1.0\nestimator_bandwidth_rad_s = 45.0\nestimator_damping = 1.0\n\
         inertia_kg_m2 = {TOLD}\n[spec]\nsettle_s = 0.001\n[loop]\nform = \"{form}\"\n\
         delay_samples = {delay}\n[sensor]\nvelocity = \"{velocity}\"\n{filter}\n\
         [world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\nfriction = \"none\"\nsubsteps = 8\n{drive}\n\
         [start]\nq_rad = 0.31\ndq_rad_s = 0.2\n[reference]\nkind = \"hold\"\nq_rad = 0.3\n"
    );
    let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("../phihat-sim/tests/support");
    Study::from_text(&text, "test.toml", &base).unwrap()
}

/// Largest difference of position \[rad\] between the simulator and the powers of the matrix.
fn difference(study: &Study) -> f64 {
    let document = requested_gains(study).unwrap();
    let model = LoopModel::from_study(study, 0);
    let form = model.form;
    let names = [document.joints[0].name.clone()];
    let gains = document.joint_gains(&names, study.control.period_ns, form).unwrap();
    let trace = Simulation::new(study, &gains).unwrap().run(|_| ()).trace;
    let matrix = StateMatrix::new(&document.joints[0], &model, ROD / TOLD);
    let mut x = start(&model, matrix.unit(), matrix.matrix().nrows());
    let mut worst = 0.0_f64;
    for q in &trace.joints[0].q {
        worst = worst.max((q - 0.3 - x[0]).abs());
        x = matrix.matrix() * x;
    }
    worst
}

/// The state before the first sample: the sensor answers the true velocity, the law adds nothing up yet.
fn start(model: &LoopModel, unit: f64, length: usize) -> DVector<f64> {
    let (q, dq) = (0.01, 0.2);
    let mut x = DVector::zeros(length);
    (x[0], x[1]) = (q, dq / unit);
    if model.form == Form::Literal {
        x[2] = -model.period_s * q * unit;
    }
    let mut next = 4;
    if model.velocity == VelocitySource::Differenced {
        x[next] = q - model.period_s * dq;
        next += 1;
    }
    if model.form == Form::Observer || model.velocity_filter_hz.is_some() {
        x[next] = dq / unit;
    }
    x
}

#[test]
fn runs_are_powers_of_the_matrix() {
    let mut worst = 0.0_f64;
    for form in ["observer", "literal"] {
        for delay in 0..3 {
            for velocity in ["measured", "differenced"] {
                for filter in ["", "velocity_filter_hz = 120.0"] {
                    for drive in ["", "drive_bandwidth_hz = 100.0"] {
                        let study = study(form, delay, velocity, filter, drive);
                        let found = difference(&study);
                        worst = worst.max(found);
                        // Runge and Kutta on a drive's exponential: 1e-9 of 0.01 rad.
                        assert!(
                            found < 1e-9,
                            "{form} {delay} {velocity} {filter} {drive}: {found:e}"
                        );
                    }
                }
            }
        }
    }
    println!("largest difference {worst:.1e} rad");
}

/// The rod at the inertia ratio `mu` of its gains, in a loop that `keys` of `[loop]`, `[sensor]` and
/// `[world]` describe.
fn rod(mu: f64, [control, sensor, world]: [&str; 3]) -> Study {
    // A spring needs a rotor behind it.
    let robot = if world.contains("flexibility") { "geared.toml" } else { "rod.urdf" };
    let text = format!(
        "duration_s = 3.0\n[robot]\nfile = \"{robot}\"\n[design]\ninertia_low_kg_m2 = {ROD}\n\
         inertia_high_kg_m2 = {ROD}\n[gains]\norder = 2\nbandwidth_rad_s = 25.0\ndamping = 1.0\n\
         estimator_bandwidth_rad_s = 75.0\nestimator_damping = 1.0\ninertia_kg_m2 = {}\n[spec]\n\
         settle_s = 0.001\n[loop]\ntorque_max_nm = \"none\"\n{control}\n[sensor]\n{sensor}\n[world]\n\
         gravity_m_s2 = [0.0, 0.0, 0.0]\nfriction = \"none\"\nsubsteps = 8\n{world}\n[start]\n\
         q_rad = 0.30001\n[reference]\nkind = \"hold\"\nq_rad = 0.3\n",
        ROD / mu
    );
    let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("../phihat-sim/tests/support");
    Study::from_text(&text, "test.toml", &base).unwrap()
}

/// Returns true if the simulator's oscillation dies out.
fn settles(study: &Study) -> bool {
    let document = requested_gains(study).unwrap();
    let form = LoopModel::from_study(study, 0).form;
    let names = [document.joints[0].name.clone()];
    let gains = document.joint_gains(&names, study.control.period_ns, form).unwrap();
    let q = &Simulation::new(study, &gains).unwrap().run(|_| ()).trace.joints[0].q;
    let largest = |q: &[f64]| q.iter().fold(0.0_f64, |most, q| most.max((q - 0.3).abs()));
    let third = q.len() / 3;
    largest(&q[2 * third..]) < largest(&q[third..2 * third])
}

/// Measurements that come late and the torque that is told in place of the one that acts: the window's edges are the
/// simulator's, within 2 %.
#[test]
fn edges_are_the_simulators() {
    let mut edges = 0;
    for form in ["form = \"observer\"", "form = \"literal\""] {
        for (control, sensor, world) in [
            ("", "sample_delay_samples = 1", ""),
            ("delay_samples = 2", "sample_delay_samples = 3", ""),
            ("delay_samples = 1", "sample_delay_samples = 2\nvelocity = \"differenced\"", ""),
            ("delay_samples = 1", "sample_delay_samples = 1", "drive_bandwidth_hz = 80.0"),
            ("delay_samples = 1", "torque = \"demanded\"", "drive_bandwidth_hz = 40.0"),
        ] {
            let control = format!("{control}\n{form}");
            let keys = [control.as_str(), sensor, world];
            let study = rod(1.0, keys);
            let record = &requested_gains(&study).unwrap().joints[0];
            let model = LoopModel::from_study(&study, 0);
            let window = InertiaWindow::find(record, &model).unwrap();
            window.verify(record, &model).unwrap();
            println!("{keys:?}: {window:?}");
            assert!(settles(&rod(window.low * 1.02, keys)), "{keys:?} above the lower edge");
            assert!(!settles(&rod(window.low / 1.02, keys)), "{keys:?} below the lower edge");
            edges += 1;
            if window.high < 100.0 {
                assert!(settles(&rod(window.high / 1.02, keys)), "{keys:?} below the upper edge");
                assert!(!settles(&rod(window.high * 1.02, keys)), "{keys:?} above the upper edge");
                edges += 1;
            }
        }
    }
    assert!(edges > 10);
}

fn gate(study: &Study) -> Result<(), String> {
    let gains = requested_gains(study).unwrap();
    let arm = Arm::of(study).unwrap();
    arm_inside_window(study, &arm, &gains).map_err(|why| why.to_string())
}

/// A drive's gain, known to the law or not: the gate's edge is the simulator's, within 2 %.
#[test]
fn gains_of_a_drive_are_judged() {
    for fed in ["applied", "demanded"] {
        let sensor = format!("torque = \"{fed}\"");
        let keys = |gain: &str| format!("[world.drive]\ngain = {gain}");
        let at = |gain: f64| rod(1.0, ["delay_samples = 4", &sensor, &keys(&gain.to_string())]);
        let (mut stable, mut unstable) = (1.0, 9.9);
        assert!(gate(&at(stable)).is_ok());
        assert!(gate(&at(unstable)).unwrap_err().contains("drive gain"));
        for _ in 0..10 {
            let middle = f64::sqrt(unstable * stable);
            *(if gate(&at(middle)).is_ok() { &mut stable } else { &mut unstable }) = middle;
        }
        println!("{fed}: {stable}");
        assert!(settles(&at(stable / 1.02)) && !settles(&at(stable * 1.02)), "{fed}: {stable}");
    }
}

/// A study with something that the loop model lacks does not arm, with key and value; what the bounds leave
/// out is reported.
#[test]
fn what_is_not_modelled_is_said() {
    for (keys, named) in [
        (["", "sample_jitter_s = 2e-4", ""], ["sensor.sample_jitter_s", "2.0"]),
        (
            ["", "", "[world.flexibility]\nstiffness_nm_rad = 900.0"],
            ["world.flexibility.stiffness_nm_rad", "9.0"],
        ),
        (
            ["", "", "[profile]\nname = \"ideal\"\ntorque_filter_hz = 70.0"],
            ["profile.torque_filter_hz", "7.0"],
        ),
    ] {
        let study = rod(1.0, keys);
        let why = gate(&study).unwrap_err();
        assert!(named.iter().all(|name| why.contains(name)), "{why}");
        let gains = requested_gains(&study).unwrap();
        let nominal = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
        let arm = Arm::of(&study).unwrap().against(nominal).unwrap();
        let certificate = Certificate::find(&study, &gains, arm, &[None]).unwrap();
        assert!(certificate.refused().unwrap().to_string().contains(named[0]));
        assert!(certificate.joints[0].sampled.is_none());
        assert!(certificate.verify(&gains).unwrap_err().to_string().contains(named[0]));
    }
    let keys = ["", "position_noise_rad = 1e-5", "[world.network]\nsample_loss = 0.01"];
    let study = rod(1.0, keys);
    gate(&study).unwrap();
    let told = phihat_design::NotCounted::of(&study);
    let told: Vec<_> = told
        .iter()
        .filter(|n| n.key != "start.q_rad" && n.claims != LeftOut::Assumed)
        .map(|n| (n.key.as_str(), n.value.as_str(), n.claims))
        .collect();
    let wanted = [
        ("sensor.position_noise_rad", "0.00001", LeftOut::Bounds),
        ("world.network.sample_loss", "0.01", LeftOut::BoundsAndStability),
    ];
    assert_eq!(told, wanted);
    // A start beside the reference is in a tube, and in nothing else.
    let told = phihat_design::NotCounted::of(&rod(1.0, ["", "", ""]));
    assert!(told.iter().all(phihat_design::NotCounted::in_tube), "{told:?}");
}
