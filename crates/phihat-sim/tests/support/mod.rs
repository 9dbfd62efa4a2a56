//! Studies of one joint with closed-form answers, run through the real simulator.
#![allow(dead_code, reason = "each test file uses its part")]

use std::path::Path;

use phihat::{JointDesign, JointGains};
use phihat_sim::{JointTrace, Simulation, SimulationOutcome};
use phihat_study::Study;

/// Inertia of the rod about its hinge \[kg·m²\].
pub(crate) const ROD_INERTIA: f64 = 0.52;

/// The arms of the repository: name, rate, nominal inertia, outer bandwidth, estimator bandwidth.
pub(crate) const ARMS: [(&str, f64, &[f64], f64, f64); 4] = [
    ("planar3r", 1000.0, &[0.42, 0.18, 0.14], 20.0, 70.0),
    ("panda", 1000.0, &[1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212], 20.0, 50.0),
    ("iiwa14", 1000.0, &[1.37, 2.43, 0.539, 0.827, 0.213, 0.209, 0.201], 20.0, 70.0),
    ("ur5", 500.0, &[1.56, 2.35, 0.945, 0.349, 0.345, 0.117], 12.0, 40.0),
];

/// A study of the rod; `rest` is appended to the text.
pub(crate) fn rod_study(top: &str, rest: &str) -> Study {
    let spec = if rest.contains("[spec]") { "" } else { "[spec]\nsettle_s = 0.001\n" };
    let text = format!(
        "{top}\n[robot]\nfile = \"rod.urdf\"\n[gains]\norder = 2\nbandwidth_rad_s = 20.0\ndamping = 1.0\n\
         estimator_bandwidth_rad_s = 70.0\nestimator_damping = 1.0\ninertia_kg_m2 = 0.52\n{spec}{rest}"
    );
    read(&text)
}

/// Reads a study's text; relative files are those of this folder.
pub(crate) fn read(text: &str) -> Study {
    let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/support");
    Study::from_text(text, "test.toml", &base).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The study's gains: bandwidth 20 rad/s, estimator 70 rad/s, m = 2, per joint `inertia`.
pub(crate) fn gains(study: &Study) -> Vec<JointGains<f64>> {
    let form = study.control.form;
    let period = study.control.period_ns as f64 * 1e-9;
    let joint = |inertia: &f64| {
        let a = &[4900.0, 140.0];
        JointGains::new(&JointDesign { inertia: *inertia, kp: 400.0, kd: 40.0, a, period, form })
            .unwrap()
    };
    study.gains.as_ref().unwrap().inertia.iter().map(joint).collect()
}

/// Runs a study under [`gains`].
pub(crate) fn run(study: &Study) -> SimulationOutcome {
    Simulation::new(study, &gains(study)).unwrap().run(|_| ())
}

/// The numeric columns of a joint.
pub(crate) fn columns(joint: &mut JointTrace) -> [&mut Vec<f64>; 15] {
    [
        &mut joint.q,
        &mut joint.dq,
        &mut joint.ddq,
        &mut joint.q_desired,
        &mut joint.dq_desired,
        &mut joint.ddq_desired,
        &mut joint.e,
        &mut joint.e_integral,
        &mut joint.de,
        &mut joint.q_measured,
        &mut joint.dq_measured,
        &mut joint.tau_command,
        &mut joint.tau_applied,
        &mut joint.phi,
        &mut joint.phi_hat,
    ]
}
