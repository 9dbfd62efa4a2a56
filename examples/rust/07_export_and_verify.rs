//! 07: gains as a file: written, read, checked by somebody else, and exported for controllers that people already run.
//!
//! On the command line: `cargo phihat verify GAINS` and `cargo phihat export GAINS --format ros`.
//!
//! Run it: `cargo run -p phihat-examples --example 07_export_and_verify`

use std::error::Error;
use std::path::Path;

use phihat_certificate::{Gains, Verified};
use phihat_design::export::{Target, export};
use phihat_design::{Arm, Outcome, Phi, PhiBasis, search};
use phihat_sim::Demand;
use phihat_study::Study;

/// Order 1, so that the law is a PID, in the form that ROS 2 has.
const STUDY: &str = r#"
duration_s = 4.0

[robot]
name = "planar3r"

[spec]
settle_s = 1.5
error_bound_rad = 0.02

[design]
payload_max_kg = 0.3
orders = [1]

[loop]
rate_hz = 1000.0
form = "literal"

[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0

[[reference.sine]]
amplitude_rad = 0.2
frequency_hz = 0.3
"#;

/// A candidate of the search joint by joint: stable, and without a bound on its error. Example 04 has one with its
/// tube.
fn designed() -> Result<Gains, Box<dyn Error>> {
    let study = Study::from_text(STUDY, "planar.toml", Path::new("."))?;
    let demand = Demand::along(&study)?;
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
    match search(&study, &Arm::of(&study)?, &phi)? {
        Outcome::Designed(gains) => Ok(*gains),
        other => Err(format!("no gains: {other:?}").into()),
    }
}

/// Verification by somebody else: nothing is needed but the text of the file.
fn check(text: &str) -> Result<Verified, Box<dyn Error>> {
    let gains = Gains::from_json(text)?;
    let certificate = gains.certificate.as_ref().ok_or("the gains carry no certificate")?;
    Ok(certificate.verified(&gains)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let gains = designed()?;
    let text = gains.to_json()?;
    println!("gains.json has {} kB", text.len() / 1000);

    // What was shown from the file, what a file cannot show of itself, and what no claim counts.
    let verified = check(&text)?;
    println!("\nproved:");
    for line in verified.proved.iter().take(4) {
        println!("  {}: {}", line.what, line.value);
    }
    println!("taken on trust:");
    for line in verified.trusted.iter().take(3) {
        println!("  {}: {}", line.what, line.value);
    }
    assert!(!verified.proved.is_empty() && !verified.trusted.is_empty());
    println!("not proved:\n  {}", verified.not_proved.join("\n  "));
    assert!(!verified.bounded);

    // Numbers come back to the same bits.
    assert!(Gains::from_json(&text)? == gains);

    // Somebody makes the window a little wider. The check has a method of its own, and names the inequality.
    let mut forged = gains.clone();
    let certificate = forged.certificate.as_mut().ok_or("no certificate")?;
    let window = certificate.joints[0].window.as_mut().ok_or("no window")?;
    window.high *= 1.1;
    let refused = check(&forged.to_json()?);
    println!("\na forged window: {}", refused.err().ok_or("the forgery should be refused")?);

    // For controllers that people already run. Each text says what its target lacks.
    for (target, word) in [(Target::Csv, "csv"), (Target::CHeader, "C"), (Target::Ros, "ROS 2")] {
        let text = export(&gains, target)?;
        println!("\n{word}: {} lines, the first of which is", text.lines().count());
        println!("  {}", text.lines().next().unwrap_or_default());
        assert!(text.contains(&gains.joints[0].name));
    }
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn Error>> {
    main()
}
