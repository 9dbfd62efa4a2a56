//! 04: gains for an error bound, with a certificate that anyone can check again.
//!
//! A study states the largest error and the largest payload. The search finds gains; the certificate says what holds
//! of them; a run shows it. On the command line all this is `cargo phihat design`, then `cargo phihat run`.
//!
//! Run it: `cargo run -p phihat-examples --example 04_design`

use std::error::Error;
use std::path::Path;

use phihat::Form;
use phihat_design::tube::{Desired, tube};
use phihat_design::{Arm, Gains, Outcome, Phi, PhiBasis, arm_inside_window, search};
use phihat_sim::{Demand, Metrics, Motion, Simulation};
use phihat_study::Study;

const STUDY: &str = r#"
duration_s = 4.0

[robot]
name = "planar3r"

[spec]
settle_s = 1.5
error_max_rad = ERROR

[design]
payload_max_kg = 0.5
orders = [1]

[loop]
rate_hz = 1000.0
delay_samples = 1

[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 100.0

[world]
payload = { mass_kg = 0.3 }

[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0

[[reference.sine]]
amplitude_rad = [0.3, 0.3, 0.3]
frequency_hz = [0.3, 0.4, 0.5]
"#;

fn study(error_max: &str) -> Result<Study, Box<dyn Error>> {
    Ok(Study::from_text(&STUDY.replace("ERROR", error_max), "planar.toml", Path::new("."))?)
}

/// Searches gains. What the search may know: the arm's inertia over its postures and payloads, and the torque φ
/// that the reference asks for beyond `M̄ q̈`.
fn find(study: &Study) -> Result<(Arm, Outcome), Box<dyn Error>> {
    let arm = Arm::of(study)?;
    let demand = Demand::along(study)?;
    let phi = |joint: usize, inertia: f64| {
        let along = demand.phi(joint, inertia);
        Phi {
            basis: PhiBasis::Reference,
            source: "inverse dynamics along the reference".to_owned(),
            size_nm: Some(along.size),
            rate_nm_s: along.rate,
            jump_nm: along.jump,
            motion: None,
        }
    };
    let outcome = search(study, &arm, &phi)?;
    Ok((arm, outcome))
}

/// Puts the tube into the certificate: an envelope of `e` and `ė` that no run in the study's scope leaves. It takes
/// the place of the bounds that count joint after joint, which the search works with: they do not hold for joints
/// that push each other. A tube may be wider than the study allows, or not close at all; then ask the search for a
/// smaller error, as `phihat design` does by itself.
fn add_tube(study: &Study, gains: &mut Gains) -> Result<(), Box<dyn Error>> {
    let motion = Motion::new(&study.reference, &study.robot, study.duration)?;
    let desired = Desired::of(study, |joint, t| motion.at(joint, t));
    let tube = tube(study, gains, &desired)?;
    let certificate = gains.certificate.as_mut().ok_or("designed gains have a certificate")?;
    for joint in &mut certificate.joints {
        (joint.bounds, joint.phi) = (None, None);
    }
    certificate.tube = Some(tube);
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let study_of_2_mrad = study("2e-3")?;
    let (arm, outcome) = find(&study_of_2_mrad)?;
    let Outcome::Designed(mut gains) = outcome else { return Err("2 mrad is possible".into()) };
    add_tube(&study_of_2_mrad, &mut gains)?;

    // The certificate is data. What checks it is another crate, which cannot see what found it.
    let certificate = gains.certificate.as_ref().ok_or("designed gains have a certificate")?;
    certificate.verify(&gains)?;
    arm_inside_window(&study_of_2_mrad, &arm, &gains)?;
    let mut bounds = Vec::new();
    for (i, joint) in certificate.joints.iter().enumerate() {
        let window = joint.window.ok_or("no window")?;
        let bound = certificate.error_bound(i).ok_or("no bound")?.error_rad;
        println!(
            "{}: stable while the inertia is {:.2} to {:.2} times M̄; |e| ≤ {:.3} mrad",
            joint.name,
            window.low,
            window.high,
            1e3 * bound
        );
        bounds.push(bound);
    }
    assert!(bounds.iter().all(|bound| *bound <= 2e-3));

    // Does a run keep it? This one carries 0.3 kg, of which nobody told the controller.
    let names: Vec<String> = study_of_2_mrad.robot.joints.iter().map(|j| j.name.clone()).collect();
    let law = gains.joint_gains(&names, study_of_2_mrad.control.period_ns, Form::Observer)?;
    let run = Simulation::new(&study_of_2_mrad, &law)?.run(|_| ());
    let metrics = Metrics::of(&run.trace, &study_of_2_mrad);
    for (joint, bound) in metrics.joints.iter().zip(&bounds) {
        println!("{}: {:.3} mrad measured", joint.name, 1e3 * joint.error_steady_max_rad);
        assert!(joint.error_steady_max_rad <= *bound);
    }

    // What cannot be had is an answer, not an error: the clause in the way, and what is possible.
    let (_, outcome) = find(&study("1e-7")?)?;
    let Outcome::Infeasible(no) = outcome else { return Err("1e-7 rad is not possible".into()) };
    for clause in &no.clauses {
        let possible = clause.possible.map_or("nothing is".to_owned(), |x| format!("{x:.1e} is"));
        println!("{}: {:.1e} asked for, {possible} possible", clause.key, clause.wanted);
    }
    assert!(!no.clauses.is_empty());
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn Error>> {
    main()
}
