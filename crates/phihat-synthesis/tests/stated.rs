//! Gains that a study states: they get a certificate, and are never replaced by others.
//! Wrong if other gains come back, if a tight specification is said to be satisfied, or if a run leaves the tube.

use std::path::Path;

use phihat_design::{Gains, Outcome, requested_gains};
use phihat_sim::Simulation;
use phihat_study::Study;
use phihat_synthesis::{Recordings, SynthesisOptions, arm_along, synthesize};

fn study(error_mrad: f64, form: &str, gains: &str) -> Study {
    let text = format!(
        "duration_s = 3.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 1.5\nerror_bound_rad = {}\n{gains}\n\
         inertia_kg_m2 = [0.42, 0.18, 0.14]\n[loop]\ndelay_samples = 1\nform = \"{form}\"\n[sensor]\nencoder_bits = \
         18\n{}[world]\npayload = {{ mass_kg = 0.2 }}\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = \
         1.0\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.3\n",
        1e-3 * error_mrad,
        if form == "observer" {
            "velocity = \"differenced\"\nvelocity_filter_hz = 100.0\n"
        } else {
            ""
        },
    );
    Study::from_text(&text, "stated.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn designed(study: &Study) -> Gains {
    let arm = arm_along(study).unwrap();
    let options = SynthesisOptions::default();
    match synthesize(study, &arm, &Recordings::default(), options).unwrap() {
        Outcome::Designed(gains) => *gains,
        Outcome::Infeasible(no) => panic!("stated gains are designed: {no:?}"),
    }
}

const BANDWIDTHS: &str =
    "[gains]\norder = 1\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 120.0";

#[test]
fn stated_gains_come_back_with_a_certificate_whose_tube_a_run_keeps() {
    for form in ["observer", "positions"] {
        let study = study(5.0, form, BANDWIDTHS);
        let gains = designed(&study);
        assert_eq!(gains.joints, requested_gains(&study).unwrap().joints, "{form}");
        let certificate = gains.certificate.as_ref().unwrap();
        certificate.verify(&gains).unwrap();
        let tube = certificate.tube.as_ref().unwrap();
        let names = study.robot.joint_names();
        let law = gains.joint_gains(&names, study.control.period_ns, study.control.form).unwrap();
        let run = Simulation::new(&study, &law).unwrap().run(|_| ());
        for (joint, (own, trace)) in tube.joints.iter().zip(&run.trace.joints).enumerate() {
            for (t, e) in run.trace.t_ns.iter().zip(&trace.e) {
                let bin = tube.bin_of(*t);
                let inside = own.error_low_rad[bin] <= *e && *e <= own.error_high_rad[bin];
                assert!(inside, "{form}, joint {joint}: {e} at {t} ns");
            }
        }
    }
}

#[test]
fn a_specification_that_stated_gains_miss_is_not_proved() {
    let study = study(0.05, "observer", BANDWIDTHS);
    let gains = designed(&study);
    assert_eq!(gains.joints, requested_gains(&study).unwrap().joints);
    let certificate = gains.certificate.as_ref().unwrap();
    certificate.verify(&gains).unwrap();
    assert!(!certificate.unproved.is_empty(), "0.05 mrad by gains of 20 rad/s");
}
