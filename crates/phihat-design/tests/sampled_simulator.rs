//! The loop model of a study is the loop that the simulator runs. Wrong if a setting of the study were read
//! differently here and there, or the simulator's order of events differed by one sample.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: a panic is the report")]

use std::path::Path;

use nalgebra::DVector;
use phihat::Form;
use phihat_design::requested_gains;
use phihat_design::sampled::{LoopForm, LoopModel, LoopVelocity, StateMatrix};
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
    let form = match model.form {
        LoopForm::Observer => Form::Observer,
        LoopForm::Literal => Form::Literal,
    };
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
    if model.form == LoopForm::Literal {
        x[2] = -model.period_s * q * unit;
    }
    let mut next = 4;
    if model.velocity == LoopVelocity::Differenced {
        x[next] = q - model.period_s * dq;
        next += 1;
    }
    if model.form == LoopForm::Observer || model.velocity_filter_hz.is_some() {
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
