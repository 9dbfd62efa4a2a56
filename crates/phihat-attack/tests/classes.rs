//! The ways in which a certificate was false, each by studies that broke it: held now, or refused with a reason.
//!
//! The first line of each study says what was claimed and measured before.

use std::path::{Path, PathBuf};

use phihat_attack::{DesignVerdict, Dice, held, judged, judged_as_typed, run};
use phihat_design::{Gains, Outcome};
use phihat_model::Workspace;
use phihat_study::Study;
use serde_json::{Value, json};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/classes")
}

fn study(name: &str) -> (Study, PathBuf) {
    let path = folder().join(format!("{name}.toml"));
    (Study::read(&path).unwrap_or_else(|e| panic!("{e}")), path)
}

/// Names of a class's studies.
fn class(letter: &str) -> Vec<String> {
    let files = std::fs::read_dir(folder()).unwrap();
    let names = files.map(|f| f.unwrap().file_name().to_string_lossy().into_owned());
    let studies = names.filter_map(|f| f.strip_suffix(".toml").map(str::to_owned));
    let mut own: Vec<_> = studies.filter(|f| f.starts_with(&format!("{letter}_"))).collect();
    own.sort();
    assert!(own.len() >= 3, "{own:?}");
    own
}

/// Returns true if the study's run stays inside of the claimed bounds, or if nothing is claimed; prints the
/// result.
fn kept(name: &str) -> bool {
    let (study, path) = study(name);
    let judged = if name.ends_with("_typed") { judged_as_typed } else { judged };
    let (gains, claim) = match judged(&study, &path) {
        DesignVerdict::Certified(gains, claim) => (gains, claim),
        DesignVerdict::NotProved(why) => {
            println!("{name}: not proved: {why}");
            return !why.is_empty();
        }
        DesignVerdict::Refuted(_, why) => {
            println!("{name}: does not verify: {why}");
            return false;
        }
        DesignVerdict::Infeasible(clauses) => {
            println!("{name}: infeasible: {clauses:?}");
            return !clauses.is_empty();
        }
    };
    let found = held(&claim, &run(&study, &gains, &[]).unwrap(), name);
    let worst = found.violations.iter().max_by(|a, b| a.ratio.total_cmp(&b.ratio));
    match worst {
        Some(v) => println!(
            "{name}: LEFT: {} of {} at {:.3} s: {:.3e}, claimed {:.3e}",
            v.signal, v.joint, v.t_s, v.measured, v.claimed.1
        ),
        None if found.outside => println!("{name}: a limit acted, nothing is claimed"),
        None => {
            let ratio = |j: &phihat_attack::JointFound| j.error_bound_rad / j.error_peak_rad;
            let ratios: Vec<_> = found.joints.iter().map(|j| format!("{:.2}", ratio(j))).collect();
            println!("{name}: kept; bound over measured {}", ratios.join(" "));
        }
    }
    found.violations.is_empty()
}

fn all_kept(letter: &str) {
    let broken: Vec<_> = class(letter).into_iter().filter(|name| !kept(name)).collect();
    assert!(broken.is_empty(), "left what was claimed: {broken:?}");
}

#[test]
fn a_coupling_moves_other_joints() {
    all_kept("a");
}

#[test]
fn b_motion_within_a_sample() {
    all_kept("b");
}

#[test]
fn c_the_start_is_part_of_the_run() {
    all_kept("c");
}

#[test]
fn f_feedback_in_phi() {
    all_kept("f");
}

#[test]
fn g_what_a_supervisor_changes() {
    all_kept("g");
}

#[test]
fn h_figures_of_another_arm() {
    all_kept("h");
}

/// No posture has an eigenvalue of inertia beyond the certificate's range: neither one found by climbing, nor the
/// study's own.
#[test]
fn d_postures() {
    let broken: Vec<_> = class("d").into_iter().filter(|name| !covers_postures(name)).collect();
    assert!(broken.is_empty(), "a posture is outside of the claimed range: {broken:?}");
}

fn covers_postures(name: &str) -> bool {
    let (study, path) = study(name);
    let gains = match phihat_session::designed(&study, &path) {
        Ok(Outcome::Designed(gains)) => gains,
        other => {
            println!("{name}: no gains: {other:?}");
            return true;
        }
    };
    let arm = &gains.certificate.as_ref().unwrap().arm;
    let mut model = study.robot.plant_model();
    if study.design.payload.mass.1 > 0.0 {
        let mass = study.design.payload.mass.1;
        let body = phihat_model::Body { mass, com: [0.0; 3], inertia: [0.0; 6] };
        model = model.with_payload_on(&study.robot.tip, &body).unwrap();
    }
    let mut workspace = Workspace::new(&model);
    let mut largest = |q: &[f64]| {
        let n = q.len();
        let mut entries = vec![0.0; n * n];
        model.mass_matrix(&mut workspace, q, &mut entries);
        eigenvalue(&entries, &arm.nominal_kg_m2)
    };
    let range = |i: usize| study.robot.joints[i].position.unwrap_or((-3.0, 3.0));
    let n = study.robot.joints.len();
    let mut dice = Dice::new(1, 1);
    let (mut best, mut most) = (vec![0.0; n], 0.0);
    for trial in 0..4000 {
        // Half of them near the best so far.
        let near = trial > 400 && trial % 8 != 0;
        let width = if trial % 3 == 0 { 0.3 } else { 0.03 };
        let q: Vec<f64> = (0..n)
            .map(|i| {
                let (low, high) = range(i);
                let draw = if near {
                    best[i] + width * dice.between(-1.0, 1.0)
                } else {
                    dice.between(low, high)
                };
                if trial == 0 { 0.0_f64.clamp(low, high) } else { draw.clamp(low, high) }
            })
            .collect();
        let found = largest(&q);
        if found > most {
            (best, most) = (q, found);
        }
    }
    println!("{name}: eigenvalue {most:.4} at {best:.2?}, claimed at most {:.4}", arm.high);
    most <= arm.high * 1.001
}

/// Largest eigenvalue of `M̄^{-1/2} M M̄^{-1/2}` from below, by the power method.
fn eigenvalue(matrix: &[f64], nominal: &[f64]) -> f64 {
    let n = nominal.len();
    let mut x = vec![1.0; n];
    let mut value = 0.0;
    for _ in 0..60 {
        let y: Vec<f64> = (0..n)
            .map(|i| {
                let entry = |j: usize| matrix[i * n + j] / (nominal[i] * nominal[j]).sqrt();
                (0..n).map(|j| entry(j) * x[j]).sum()
            })
            .collect();
        let norm = y.iter().map(|v| v * v).sum::<f64>().sqrt();
        value = norm;
        x = y.iter().map(|v| v / norm).collect();
    }
    value
}

/// Name of an edit, and the edit.
type Edit = (&'static str, fn(&mut Value));

/// An edited file is not believed: it is refuted, or claims nothing.
#[test]
fn e_an_edited_file_is_refused() {
    let (study, path) = study("a_planar3r_friction");
    let Ok(Outcome::Designed(gains)) = phihat_session::designed(&study, &path) else {
        panic!("no gains");
    };
    let original: Value = serde_json::from_str(&gains.to_json().unwrap()).unwrap();
    let edits: [Edit; 4] = [
        ("rate_hz", |file| file["rate_hz"] = json!(100.0)),
        ("no joints", |file| {
            file["joints"] = json!([]);
            file["certificate"]["joints"] = json!([]);
            file["certificate"]["arm"]["nominal_kg_m2"] = json!([]);
        }),
        ("all nominal inertias", |file| {
            let times = |x: &mut Value| *x = json!(0.05 * x.as_f64().unwrap());
            for joint in file["joints"].as_array_mut().unwrap() {
                times(&mut joint["inertia_kg_m2"]);
            }
            let arm = &mut file["certificate"]["arm"];
            arm["nominal_kg_m2"].as_array_mut().unwrap().iter_mut().for_each(times);
        }),
        ("joint names", |file| {
            for k in 0..3 {
                file["joints"][k]["name"] = json!("joint1");
                file["certificate"]["joints"][k]["name"] = json!("joint1");
            }
        }),
    ];
    let mut believed = Vec::new();
    for (name, edit) in edits {
        let mut file = original.clone();
        edit(&mut file);
        match refused(&file, &study) {
            Some(why) => println!("{name}: {why}"),
            None => believed.push(name),
        }
    }
    assert!(believed.is_empty(), "believed: {believed:?}");
}

/// Why a file is not believed.
fn refused(file: &Value, _study: &Study) -> Option<String> {
    let gains = match Gains::from_json(&file.to_string()) {
        Ok(gains) => gains,
        Err(why) => return Some(why.to_string()),
    };
    let Some(certificate) = &gains.certificate else { return Some("no certificate".to_owned()) };
    certificate.verify(&gains).err().map(|why| why.to_string())
}
