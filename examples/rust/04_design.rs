//! 04: gains for an error bound, with a certificate that anyone can check again.
//!
//! A study states the largest error and the largest payload. The search finds gains; the certificate says what holds
//! of them; a run shows it. On the command line all this is `cargo phihat design`, then `cargo phihat run`.
//!
//! Run it: `cargo run -p phihat-examples --example 04_design`

use std::error::Error;
use std::path::Path;

use phihat_design::Outcome;
use phihat_session::{Session, designed};
use phihat_study::Study;

const STUDY: &str = r#"
duration_s = 4.0

[robot]
name = "planar3r"

[spec]
settle_s = 1.5
error_bound_rad = ERROR

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

fn study(error_bound: &str) -> Result<Box<Study>, Box<dyn Error>> {
    let text = STUDY.replace("ERROR", error_bound);
    Ok(Box::new(Study::from_text(&text, "planar.toml", Path::new("."))?))
}

fn main() -> Result<(), Box<dyn Error>> {
    let study_of_2_mrad = study("2e-3")?;
    let path = Path::new("planar.toml");
    let outcome = designed(&study_of_2_mrad, path)?;
    let Outcome::Designed(gains) = outcome else { return Err("2 mrad is possible".into()) };

    // The certificate is data. What checks it is another crate, which cannot see what found it.
    let certificate = gains.certificate.as_ref().ok_or("designed gains have a certificate")?;
    certificate.verify(&gains)?;
    let mut bounds = Vec::new();
    for (i, joint) in certificate.joints.iter().enumerate() {
        let window = joint.window.ok_or("no window")?;
        let bound = certificate.error_bound(i).ok_or("no bound")?.error_bound_rad;
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

    // Does a run keep it? This one carries 0.3 kg, of which nobody told the controller. A session arms the gains: it
    // refuses those whose window does not hold the arm.
    let given = Some((*gains, Path::new("gains.json")));
    let session = Session::new(study_of_2_mrad, path, given, false)?;
    let (done, _) = session.run(|_| ());
    for (joint, bound) in done.metrics.joints.iter().zip(&bounds) {
        println!("{}: {:.3} mrad measured", joint.name, 1e3 * joint.error_steady_max_rad);
        assert!(joint.error_steady_max_rad <= *bound);
    }
    assert_eq!(done.verdict(), "within_spec");

    // What cannot be had is an answer, not an error: the clause in the way, and what is possible.
    let outcome = designed(&*study("1e-7")?, path)?;
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
