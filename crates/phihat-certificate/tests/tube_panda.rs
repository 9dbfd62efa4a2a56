//! scratch
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr, reason = "tests: a panic is the report")]

mod support;
use phihat_certificate::tube::{Law, PayloadSet};
use support::{Case, Draw, hold};

#[test]
fn panda_by_hand() {
    let Ok(path) = std::env::var("PHIHAT_TUBE_GAINS") else { return };
    let study = std::env::var("PHIHAT_TUBE_STUDY").unwrap();
    let mut text = std::fs::read_to_string(study).unwrap();
    if let Ok(d) = std::env::var("PHIHAT_TUBE_DURATION") { text = text.replace("duration_s = 10.0", &format!("duration_s = {d}")); text = text.replace("settle_s = 2.0", "settle_s = 0.5"); }
    let gains: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let laws: Vec<Law> = gains["joints"].as_array().unwrap().iter().map(|j| Law {
        name: j["name"].as_str().unwrap().to_owned(),
        inertia: j["inertia_kg_m2"].as_f64().unwrap(),
        kp: j["kp_per_s2"].as_f64().unwrap(), kd: j["kd_per_s"].as_f64().unwrap(),
        a: j["a"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect() }).collect();
    eprintln!("{:?}", laws[0]);
    let mut case = Case::with(&text, laws, Some(100.0));
    let n = case.laws.len();
    let mode = std::env::var("PHIHAT_TUBE_MODE").unwrap_or_default();
    let f = 0.3;
    if mode.contains('f') { case.coulomb = (vec![0.0; n], vec![f; n]); }
    if mode.contains('p') {
        case.payload = Some(PayloadSet { frame: "panda_link8".into(), mass: (0.0, 1.0), com: [(-0.03, 0.03), (-0.03, 0.03), (0.02, 0.08)], gyration: 0.0 });
    } else {
        case.payload = Some(PayloadSet { frame: "panda_link8".into(), mass: (0.5, 0.5), com: [(0.0, 0.0), (0.0, 0.0), (0.05, 0.05)], gyration: 0.0 });
    }
    let t0 = std::time::Instant::now();
    let tube = case.derive().unwrap();
    eprintln!("derive {:?}, slices {}", t0.elapsed(), tube.slices);
    let mrad = |x: &f64| (x * 1e6).round() / 1e3;
    eprintln!("tube e {:?}", tube.joints.iter().map(|j| mrad(&j.error_max_rad)).collect::<Vec<_>>());
    eprintln!("tube v {:?}", tube.joints.iter().map(|j| mrad(&j.velocity_error_max_rad_s)).collect::<Vec<_>>());
    eprintln!("tube whole {:?}", tube.joints.iter().map(|j| mrad(&j.error_low_rad.iter().chain(&j.error_high_rad).fold(0.0_f64, |m, x| m.max(x.abs())))).collect::<Vec<_>>());
    eprintln!("torque {:?} step {:?}", tube.joints.iter().map(|j| j.torque_max_nm).collect::<Vec<_>>(), tube.joints.iter().map(|j| j.torque_step_max_nm).collect::<Vec<_>>());
    let mut worst = vec![0.0_f64; n];
    let mut out = f64::NEG_INFINITY;
    let masses: Vec<(f64, [f64; 3])> = if mode.contains('p') { vec![(1.0, [0.03, 0.03, 0.08]), (1.0, [-0.03, 0.03, 0.08]), (0.0, [0.0; 3]), (0.5, [0.0, 0.0, 0.05])] } else { vec![(0.5, [0.0, 0.0, 0.05])] };
    for payload in masses {
        for level in if mode.contains('f') { vec![0.0, f] } else { vec![f] } {
            let trace = case.run(&Draw { payload: Some(payload), coulomb: vec![level; n], ..Draw::default() });
            let held = hold(&tube, &trace);
            out = out.max(held.outside);
            for i in 0..n { worst[i] = worst[i].max(held.error_max[i]); }
        }
    }
    eprintln!("measured {:?} outside {out:e}", worst.iter().map(mrad).collect::<Vec<_>>());
    assert!(out < 0.0);
}
