//! A low-pass on the torque command from the study to the certificate and a run: both forms of the law on a small arm.
//! Wrong if a run leaves the error bound of gains that verify, if the second derivation of the tube finds it too
//! narrow, if the gains run without the filter, or if a certificate for another filter verifies.

use std::path::Path;

use phihat_certificate::tube::TubeReference;
use phihat_design::{Gains, Outcome};
use phihat_sim::{Metrics, Motion, Simulation, fed_along};
use phihat_study::Study;
use phihat_synthesis::{Recordings, SynthesisOptions, arm_along, synthesize};

/// A planar arm under some load and dry friction, whose torque goes through a low-pass.
fn study(form: &str, world: &str) -> Study {
    let text = format!(
        "duration_s = 3.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 1.0\nerror_bound_rad = 2e-2\n\
         [design]\npayload_max_kg = 0.3\norders = [1]\ncoulomb_min_nm = 0.0\ncoulomb_max_nm = \
         0.05\n[loop]\ndelay_samples = 1\nform = \"{form}\"\ntorque_filter_hz = 120.0\n[sensor]\nencoder_bits = \
         24\nvelocity = \"differenced\"\nvelocity_filter_hz = 100.0\n[world]\nfriction = \"none\"\ngravity_m_s2 = \
         [0.0, 0.0, 0.0]\nsubsteps = 4\n{world}\n[reference]\nkind = \"sines\"\ncenter_rad = [0.3, 0.8, \
         0.4]\nfade_in_s = 1.0\n[[reference.sine]]\namplitude_rad = 0.1\nfrequency_hz = 0.2\n"
    );
    Study::from_text(&text, "arm.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

const HEAVY: &str = "coulomb_extra_nm = 0.05\npayload = { mass_kg = 0.3 }";
const LIGHT: &str = "coulomb_extra_nm = 0.0\npayload = { mass_kg = 0.01 }";

fn designed(study: &Study) -> Gains {
    let arm = arm_along(study).unwrap();
    let options = SynthesisOptions::default();
    let outcome = synthesize(study, &arm, &Recordings::default(), options).unwrap();
    let Outcome::Designed(gains) = outcome else { panic!("2e-2 rad are possible") };
    *gains
}

/// Largest error of each joint in a run \[rad\], and a trace of torques.
fn run(study: &Study, gains: &Gains) -> Vec<f64> {
    let names = study.robot.joint_names();
    let law = gains.joint_gains(&names, study.control.period_ns, study.control.form).unwrap();
    let outcome = Simulation::new(study, &law).unwrap().run(|_| ());
    assert!(outcome.divergence.is_none());
    let metrics = Metrics::of(&outcome.trace, study);
    metrics.joints.iter().map(|joint| joint.error_steady_max_rad).collect()
}

fn derived_again(study: &Study, gains: &Gains) {
    let motion = Motion::of(study).unwrap();
    let n = study.robot.joints.len();
    let reference = TubeReference::of(study, |t| (0..n).map(|i| motion.told(i, t)).collect());
    let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let fed = fed_along(study, &motion, &inertia, reference.q.len()).unwrap();
    let reference = reference.feeding(&fed);
    let certificate = gains.certificate.as_ref().unwrap();
    let again = certificate.derive_tube(gains, (study, &reference), &|_| ()).unwrap().unwrap();
    assert_eq!(again.on_trust, None);
    for joint in &again.joints {
        println!("{joint:?}");
    }
}

#[test]
fn gains_behind_a_low_pass_hold_their_bound() {
    // The gate tries the law from positions, `--all` the observer too.
    let all = std::env::var_os("PHIHAT_ALL").is_some();
    for form in if all { &["positions", "observer"][..] } else { &["positions"] } {
        let study_of = |world: &str| study(form, world);
        let heavy = study_of(HEAVY);
        let gains = designed(&heavy);
        assert_eq!(gains.torque_filter_hz, Some(120.0));
        let certificate = gains.certificate.clone().unwrap();
        assert!(certificate.verified(&gains).unwrap().bounded, "{form}");
        derived_again(&heavy, &gains);
        for world in [HEAVY, LIGHT, "coulomb_extra_nm = 0.02\npayload = { mass_kg = 0.15 }"] {
            let errors = run(&study_of(world), &gains);
            for (joint, error) in errors.iter().enumerate() {
                let bound = certificate.error_bound(joint).unwrap().error_bound_rad;
                println!("{form} {world:?} {joint}: {error:.3e} of {bound:.3e}");
                assert!(*error <= bound, "{form} {world} {joint}");
            }
        }
        // Gains that say another filter than their claims are about.
        for other in [None, Some(60.0)] {
            let forged = Gains { torque_filter_hz: other, ..gains.clone() };
            let why = certificate.verify(&forged).unwrap_err();
            assert_eq!(why.inequality, "torque filter is that of the gains");
        }
    }
}
