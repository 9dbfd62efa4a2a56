//! Certified bounds hold on runs: every committed study whose gains can be certified, and the designs of several
//! arms, in closed loop against the simulator. Wrong if a steady error passed its bound while no limit acted.

use std::fs;
use std::path::Path;

use phihat::Form;
use phihat_design::prelude::*;
use phihat_design::{Arm, Certificate, Gains, NotCounted, Outcome, design, requested_gains};
use phihat_session::phi_along;
use phihat_sim::{Demand, Metrics, Simulation};
use phihat_study::Study;

/// Seconds of steady motion that are looked at.
const STEADY: f64 = 2.0;

/// The study's gains with a certificate; `None` where a claim is refused, with the reason told.
fn certified(study: &Study) -> Option<Gains> {
    let demand = Demand::along(study).unwrap();
    let arm = Arm::of(study).unwrap();
    let of = |joint: usize, inertia: f64| phi_along(&demand, joint, inertia);
    let refused = |why: &dyn std::fmt::Display| println!("{}: nothing to hold, {why}", study.name);
    let gains = if let Some(mut gains) = requested_gains(study) {
        let nominal: Vec<f64> = gains.joints.iter().map(|j| j.inertia_kg_m2).collect();
        let known: Vec<_> = nominal.iter().enumerate().map(|(j, m)| Some(of(j, *m))).collect();
        let found = Certificate::find(study, &gains, arm.against(nominal).unwrap(), &known);
        gains.certificate = Some(found.map_err(|why| refused(&why)).ok()?);
        gains
    } else {
        match design(study, &arm, &of).unwrap() {
            Outcome::Designed(gains) => *gains,
            // By itself each joint has the arm's whole range; the arm has its tube.
            Outcome::Infeasible(no) if study.control.form == Form::Positions => {
                refused(&no);
                return None;
            }
            Outcome::Infeasible(no) => panic!("{}: {no:?}", study.name),
        }
    };
    if let Some(why) = gains.certificate.as_ref().unwrap().refused() {
        refused(&why);
        return None;
    }
    Some(gains)
}

/// Runs a study and holds each joint against its bounds. The least certified bound over measured error; `None` where
/// a limit acted or nothing is certified.
fn tightest(mut study: Study) -> Option<f64> {
    study.duration = study.duration.min(study.spec.settle + STEADY);
    let gains = certified(&study)?;
    gains.complete(&mut study).unwrap();
    let certificate = gains.certificate.as_ref().unwrap();
    certificate.verify(&gains).unwrap();
    let form = study.control.form;
    let names: Vec<String> = study.robot.joints.iter().map(|j| j.name.clone()).collect();
    let law = gains.joint_gains(&names, study.control.period_ns, form).unwrap();
    let outcome = Simulation::new(&study, &law).unwrap().run(|_| ());
    assert!(outcome.divergence.is_none(), "{}", study.name);
    let metrics = Metrics::of(&outcome.trace, &study);
    let limited = metrics.joints.iter().any(|j| j.saturated_samples + j.rate_limited_samples > 0);
    let mut least = f64::INFINITY;
    for (joint, claim) in metrics.joints.iter().zip(&certificate.joints) {
        let bounds = claim.bounds.unwrap();
        let (e, de) = (joint.error_steady_max_rad, joint.velocity_error_steady_max_rad_s);
        let ratios = (bounds.error_rad / e, bounds.velocity_error_rad_s / de);
        println!(
            "{} {}: |e| {:.4} of {:.4} mrad, |ė| {:.3} of {:.3} mrad/s{}",
            study.name,
            joint.name,
            e * 1e3,
            bounds.error_rad * 1e3,
            de * 1e3,
            bounds.velocity_error_rad_s * 1e3,
            if limited { ", a limit acted" } else { "" }
        );
        if !limited {
            assert!(ratios.0 >= 1.0, "{} {}: |e| passed its bound", study.name, joint.name);
            assert!(ratios.1 >= 1.0, "{} {}: |ė| passed its bound", study.name, joint.name);
        }
        least = least.min(ratios.0);
    }
    (!limited).then_some(least)
}

#[test]
fn on_every_committed_study() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    let mut held = 0;
    let mut files: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    for file in files.iter().filter(|f| f.extension().is_some_and(|e| e == "toml")) {
        let study = Study::read(file).unwrap();
        // What chooses a form, or is fed forward, is judged by its tube.
        let by_tube = study.control.form_designed || study.feedforward.is_some();
        if !NotCounted::of(&study).is_empty() || by_tube {
            continue;
        }
        if let Some(least) = tightest(study) {
            held += 1;
            println!("{}: bound over measured at least {least:.2}\n", file.display());
        }
    }
    assert!(held >= 5, "only {held} studies have a bound that can be held");
}

/// A Panda on sinusoids that get faster: what the motion costs by late velocity and late torque is in the bounds.
fn fast(frequency: f64, error: f64, late: u32) -> Study {
    let text = format!(
        "duration_s = 8.0\n[robot]\nname = \"panda\"\n[spec]\nsettle_s = 3.0\nerror_max_rad = {error}\n\
         [design]\npayload_max_kg = 0.5\n[loop]\ndelay_samples = 1\n[sensor]\nencoder_bits = 20\n\
         sample_delay_samples = {late}\nvelocity = \"differenced\"\nvelocity_filter_hz = 60.0\n[world]\nfriction = \"none\"\n\
         substeps = 4\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 1.0\n\
         [[reference.sine]]\namplitude_rad = 0.15\nfrequency_hz = {frequency}\nphase_rad = 0.7\n"
    );
    Study::from_text(&text, "fast.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

#[test]
fn on_motions_that_get_faster() {
    for (frequency, error, late) in [(0.2, 0.02, 0), (1.0, 0.01, 0), (2.0, 0.02, 0), (1.0, 0.03, 3)]
    {
        let least = tightest(fast(frequency, error, late));
        println!("{frequency} Hz, measured {late} samples late: {least:?}\n");
        assert!(least.is_some());
    }
}
