//! The error of a coupled arm has no bound without its tube: a candidate of the search joint by joint states none, and
//! its tube holds in a run in which a joint is pushed by another one far beyond what it could have alone.
//! Wrong if a run leaves the error bound of a certificate that verifies, or if a candidate states a bound.

use std::path::Path;

use phihat_design::tube::PARTS;
use phihat_design::{Arm, Gains, Outcome, arm_inside_window, design};
use phihat_sim::{Demand, Metrics, Simulation};
use phihat_study::Study;
use phihat_synthesis::{bound_by_tube, phi_along};

/// A planar arm without gravity whose first joint alone has dry friction: where it turns round, it pushes the others.
fn study() -> Study {
    let text = "duration_s = 6.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 2.0\nerror_bound_rad = 3e-3\n\
         [design]\npayload_max_kg = 0.3\norders = [1]\n[loop]\ndelay_samples = 1\n[sensor]\nencoder_bits = 24\n\
         velocity = \"differenced\"\nvelocity_filter_hz = 100.0\n[world]\nfriction = \"none\"\n\
         gravity_m_s2 = [0.0, 0.0, 0.0]\ncoulomb_extra_nm = [2.0, 0.0, 0.0]\nsubsteps = 8\n\
         payload = { mass_kg = 0.3 }\n[reference]\nkind = \"sines\"\ncenter_rad = [0.3, 0.8, 0.4]\n\
         fade_in_s = 1.0\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.2\n";
    Study::from_text(text, "arm.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The candidate, with the checks that a user makes before a run.
fn candidate(study: &Study) -> Gains {
    let demand = Demand::along(study).unwrap();
    let arm = Arm::of(study).unwrap();
    let outcome = design(study, &arm, &|joint, inertia| phi_along(&demand, joint, inertia));
    let Outcome::Designed(gains) = outcome.unwrap() else { panic!("3 mrad are possible") };
    gains.certificate.as_ref().unwrap().verify(&gains).unwrap();
    arm_inside_window(study, &arm, &gains).unwrap();
    *gains
}

/// Largest steady error of each joint in a run \[rad\].
fn measured(study: &Study, gains: &Gains) -> Vec<f64> {
    let names = study.robot.joint_names();
    let law = gains.joint_gains(&names, study.control.period_ns, study.control.form).unwrap();
    let outcome = Simulation::new(study, &law).unwrap().run(|_| ());
    assert!(outcome.divergence.is_none());
    let metrics = Metrics::of(&outcome.trace, study);
    metrics.joints.iter().map(|joint| joint.error_steady_max_rad).collect()
}

/// Error \[rad\] that each joint would have at most if no other joint moved it, by the claims about its loop and `φ`.
fn alone(study: &Study, gains: &Gains) -> Vec<f64> {
    let demand = Demand::along(study).unwrap();
    let joints = gains.joints.iter().zip(&gains.certificate.as_ref().unwrap().joints);
    let alone = joints.enumerate().map(|(i, (record, claims))| {
        let phi = phi_along(&demand, i, record.inertia_kg_m2);
        let peaks = claims.sampled.as_ref().unwrap();
        let moved = claims.reference.as_ref().unwrap();
        let quantum = claims.noise.as_ref().unwrap().quantum_rad;
        phi.bound(peaks.jump[1], peaks.ramp[1]) / record.inertia_kg_m2
            + 0.5 * quantum * claims.reading.as_ref().unwrap().error
            + phi.motion.unwrap().costs(moved.acceleration, moved.jerk)
    });
    alone.collect()
}

#[test]
fn a_run_leaves_what_a_joint_alone_allows_and_stays_inside_the_tube() {
    let study = study();
    let mut gains = candidate(&study);
    let (run, alone) = (measured(&study, &gains), alone(&study, &gains));
    println!("measured {run:?}\nalone {alone:?}");
    assert!(run[1] > 3.0 * alone[1], "the joints push each other: {run:?} {alone:?}");

    // A bound, where one is stated, holds; of the candidate none is.
    let within = |gains: &Gains, joint: usize, error: f64| {
        let bound = gains.certificate.as_ref().unwrap().error_bound(joint);
        println!("joint {joint}: {error:.3e} measured, {bound:?}");
        assert!(
            bound.is_none_or(|bound| error <= bound.error_bound_rad),
            "joint {joint}: {bound:?}"
        );
        bound.is_some()
    };
    for (joint, error) in run.iter().enumerate() {
        assert!(!within(&gains, joint, *error), "a bound without a tube");
    }
    let verified = gains.certificate.as_ref().unwrap().verified(&gains).unwrap();
    assert!(!verified.bounded && verified.not_proved[0].contains("no tube"), "{verified:?}");

    bound_by_tube(&study, &mut gains, PARTS).unwrap();
    let verified = gains.certificate.as_ref().unwrap().verified(&gains).unwrap();
    assert!(verified.bounded, "{verified:?}");
    for (joint, error) in run.iter().enumerate() {
        assert!(within(&gains, joint, *error), "no bound with a tube");
    }
}
