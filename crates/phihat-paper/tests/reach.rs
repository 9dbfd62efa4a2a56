//! Order switching without a torque jump, and the map of where the printed law holds against simulated arms.

use std::path::Path;

use phihat::Form;
use phihat_design::{Arm, requested_gains};
use phihat_paper::arm::{Studies, order_switching};
use phihat_paper::reach::reach;
use phihat_paper::{Extent, PaperPart, Verdict};
use phihat_report::kit::figure::Content;
use phihat_sim::Simulation;
use phihat_study::Study;

const QUICK: Extent = Extent { quick: true };

fn value(part: &PaperPart, name: &str) -> f64 {
    let statement = &part.sections[0].statements[0];
    let number = statement.numbers.iter().find(|number| number.name == name);
    number.unwrap_or_else(|| panic!("no {name}")).value.unwrap()
}

/// The change must not be seen in the torque: a sample after it, at most a hundredth of the torque it started with.
#[test]
fn a_change_of_order_hands_the_estimate_over() {
    let part = order_switching(&Studies::shipped(), QUICK, &|_| ()).unwrap();
    assert_eq!(part.sections[0].statements[0].verdict, Verdict::WithCorrection);
    let naive = value(&part, "jump of φ̂ with the integrals as they stand");
    for gains in ["m = 2, H1", "m = 2, H2", "m = 2, H3"] {
        let step = value(&part, &format!("change of torque at it, {gains}"));
        assert!(step < 0.01 * naive, "{gains}: {step} N·m, {naive} N·m");
    }
}

/// Less a_0 at the start requires less torque, as φ̂(0) is proportional to it; the steady error is that of the
/// full gain.
#[test]
fn less_gain_in_the_transient_asks_for_less_torque() {
    let part = order_switching(&Studies::shipped(), QUICK, &|_| ()).unwrap();
    let statement = &part.sections[0].statements[1];
    assert_eq!(statement.id, "gains-in-transient");
    let value = |name: &str| {
        let number = statement.numbers.iter().find(|number| number.name == name);
        number.unwrap_or_else(|| panic!("no {name}")).value.unwrap()
    };
    let full = value("largest torque, a_0 = 69.6 from the start");
    let mut last = full;
    for a0 in [40, 20, 10] {
        let torque = value(&format!("largest torque, a_0 = {a0} at the start"));
        assert!(torque < last, "a_0 = {a0}: {torque} N·m");
        last = torque;
    }
    // Of flatter there is no word unless every overshoot is less.
    let overshoot = |name: &str| value(&format!("overshoot of joint 2, {name}"));
    let flat = [40, 20, 10].iter().all(|a0| {
        overshoot(&format!("a_0 = {a0} at the start")) < overshoot("a_0 = 69.6 from the start")
    });
    assert_eq!(statement.verdict == Verdict::AsPrinted, flat);
}

/// An outer loop faster than the estimator does not settle: no change, and no verdict in its favour.
#[test]
fn without_settling_there_is_no_change_and_nothing_is_claimed() {
    let stiff = Studies::shipped().replaced("kp_per_s2 = 400.0", "kp_per_s2 = 4e5");
    let part = order_switching(&stiff, QUICK, &|_| ()).unwrap();
    assert_eq!(part.sections[0].statements[0].verdict, Verdict::Open);
}

/// The arm of a map, held at a pose and pushed a little: whether it comes back. An arm `scale` times as large under
/// `M̄` is the arm as it is under `M̄/scale`.
fn comes_back(arm: &str, nominal: &[f64], (a, form, rate): (&str, Form, f64), pose: &str) -> bool {
    let inertia: Vec<String> = nominal.iter().map(|m| format!("{m:e}")).collect();
    let text = format!(
        "duration_s = 3.0\n[robot]\nname = \"{arm}\"\n[gains]\nkp_per_s2 = 400.0\nkd_per_s = 40.0\na = {a}\n\
         inertia_kg_m2 = [{}]\n[loop]\nrate_hz = {rate}\ndelay_samples = 1\ntorque_max_nm = \"none\"\n\
         [world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\nfriction = \"none\"\nsubsteps = 4\n\
         [reference]\nkind = \"hold\"\npose = \"{pose}\"\n",
        inertia.join(", ")
    );
    let mut study = Study::from_text(&text, "cell.toml", Path::new("")).unwrap();
    let mut start = study.robot.poses[pose].clone();
    start.iter_mut().enumerate().for_each(|(i, q)| *q += 1e-6 * (i as f64 + 1.0));
    study.world.start = Some(phihat_study::Start { dq: vec![0.0; start.len()], q: start });
    let names = study.robot.joint_names();
    let gains = requested_gains(&study).unwrap();
    let law = gains.joint_gains(&names, study.control.period_ns, form).unwrap();
    let outcome = Simulation::new(&study, &law).unwrap().run(|_| ());
    let worst = |from: usize, to: usize| {
        let errors = outcome.trace.joints.iter().flat_map(|joint| &joint.e[from..to]);
        errors.fold(0.0, |most: f64, e| most.max(e.abs()))
    };
    let samples = outcome.trace.len();
    outcome.divergence.is_none() && worst(samples - samples / 10, samples) < worst(0, samples / 10)
}

/// `M̄ per joint` of the map, from the same postures.
fn nominal(arm: &str) -> Vec<f64> {
    let text = format!(
        "duration_s = 2.0\n[robot]\nname = \"{arm}\"\n[gains]\nbandwidth_rad_s = 20.0\n\
         estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = 1.0\n[reference]\nkind = \"hold\"\npose = \"ready\"\n"
    );
    let study = Study::from_text(&text, "arm.toml", Path::new("")).unwrap();
    Arm::of(&study).unwrap().nominal()
}

/// Wrong if a cell said stable and the arm ran away, or an arm far outside came back.
#[test]
fn the_maps_cells_are_what_simulated_arms_do() {
    let part = reach(QUICK, &|_| ()).unwrap();
    let laws = ["[69.6]", "[4844.0, 69.6]"];
    let (mut stable, mut unstable) = (0, 0);
    // Two maps for each of two arms; the gate tries every third cell.
    let every = if std::env::var_os("PHIHAT_ALL").is_some() { 1 } else { 3 };
    let mut cell = 0;
    for (k, panel) in part.sections[0].figures[0].panels.iter().enumerate() {
        let arm = if k < 2 { "planar3r" } else { "panda" };
        let (nominal, a) = (nominal(arm), laws[k % 2]);
        let Content::Map { x, y, cells, .. } = &panel.content else { panic!("a map") };
        for (row, scale) in cells.iter().zip(y) {
            let ones = vec![1.0 / scale; nominal.len()];
            for (class, rate) in row.iter().zip(x) {
                cell += 1;
                if cell % every != 0 {
                    continue;
                }
                let printed = comes_back(arm, &ones, (a, Form::Literal, *rate), "ready");
                if class & 1 == 1 {
                    assert!(printed, "{arm} {a}, scale {scale}, {rate} Hz: printed law");
                    stable += 1;
                } else if *scale < 0.02 && *rate < 2000.0 || *scale > 60.0 {
                    assert!(!printed, "{arm} {a}, scale {scale}, {rate} Hz: printed law");
                    unstable += 1;
                }
            }
        }
        for (class, rate) in cells[0].iter().zip(x).filter(|(class, _)| **class & 2 == 2) {
            let ours = comes_back(arm, &nominal, (a, Form::Observer, *rate), "ready");
            assert!(ours, "{arm} {a}, {rate} Hz, class {class}: M̄ per joint");
        }
    }
    assert!(
        stable * every >= 15 && unstable * every >= 30,
        "{stable} stable, {unstable} unstable cells tried"
    );
}
