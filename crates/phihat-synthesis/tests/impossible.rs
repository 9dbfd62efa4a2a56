//! A study with an error that no law keeps: refused before any search, then with one that can be asked for. Wrong if
//! an error below half a step of the encoder is searched for before its refusal, if one above is refused by this
//! inequality, if a design for the error that is offered misses it by more than a tenth, or if a design's bound is
//! below the encoder's half step.

use core::f64::consts::PI;
use core::ops::ControlFlow;
use std::cell::RefCell;
use std::path::Path;

use phihat_design::Outcome;
use phihat_study::Study;
use phihat_synthesis::{
    Recordings, Steps, SynthesisOptions, arm_along, synthesize, synthesize_in_steps,
};

/// Bits of the encoders.
const BITS: u8 = 20;

/// Any motion of a class.
const ANY: &str = "kind = \"any\"\ncenter = \"ready\"\nbox_rad = 0.2\nspeed_max_rad_s = \
                   0.2\nacceleration_max_rad_s2 = 0.5\njerk_max_rad_s3 = 5.0\n";

/// One motion.
const SINES: &str = "kind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 0.5\n[[reference.sine]]\namplitude_rad = \
                     0.1\nfrequency_hz = 0.5\n";

/// Three joints in a plane without friction, a reference, and an error bound \[rad\].
fn study(reference: &str, error_rad: f64) -> Study {
    let text = format!(
        "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 1.0\nerror_bound_rad = {error_rad:e}\n\
         [design]\npayload_max_kg = 0.05\ntorque_step_max_nm = 1.0\nwindow_margin = 1.1\norders = [1]\n[loop]\n\
         delay_samples = 1\nform = \"positions\"\n[sensor]\nencoder_bits = {BITS}\n[start]\ntorque_nm = \
         \"balance\"\n[reference]\n{reference}"
    );
    let study = Study::from_text(&text, "arm.toml", Path::new("."));
    study.unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// In the unit of a page, four digits.
fn milli(value_rad: f64) -> f64 {
    format!("{:.3e}", 1e3 * value_rad).parse().unwrap()
}

fn outcome(reference: &str, error_rad: f64) -> Outcome {
    let study = study(reference, error_rad);
    let arm = arm_along(&study).unwrap();
    synthesize(&study, &arm, &Recordings::default(), SynthesisOptions::default()).unwrap()
}

#[test]
fn an_error_that_no_law_keeps_is_refused_with_one_that_a_design_reaches() {
    let half_step = PI / f64::from(1_u32 << BITS);
    let Outcome::Infeasible(no) = outcome(ANY, 0.99 * half_step) else {
        panic!("no law reads finer")
    };
    assert!(no.beyond_any_law, "{no}");
    assert_eq!(no.clauses.len(), 3, "{no}");
    assert!(no.words[0].contains(&format!("{} mrad (encoder step", milli(half_step))), "{no}");
    let possible: Vec<f64> = no.clauses.iter().filter_map(|clause| clause.possible).collect();
    assert_eq!(possible.len(), 3, "{no}");
    let most = possible.iter().copied().fold(0.0, f64::max);
    // What is offered, "about", is reached, by a bound that is wider than a half step.
    let Outcome::Designed(gains) = outcome(ANY, most) else { panic!("{most} is possible") };
    let certificate = gains.certificate.as_ref().unwrap();
    let class = certificate.class.as_ref().unwrap();
    for bound in &class.error_bound_rad {
        assert!((half_step..=1.1 * most).contains(bound), "{bound} {half_step} {most}");
    }
}

/// The first steps of a design, which is then cancelled.
fn first_steps(reference: &str, error_rad: f64) -> Vec<String> {
    let study = study(reference, error_rad);
    let arm = arm_along(&study).unwrap();
    let steps = RefCell::new(Vec::new());
    let begins = |step: &str| {
        steps.borrow_mut().push(step.to_owned());
        if steps.borrow().len() < 3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let (recordings, options) = (Recordings::default(), SynthesisOptions::default());
    let ended = synthesize_in_steps(&study, (&arm, &recordings), options, Steps::to(&begins));
    assert!(ended.is_err_and(|why| why.to_string() == "cancelled"));
    steps.into_inner()
}

#[test]
fn the_refusal_is_the_first_that_is_said() {
    let half_step = PI / f64::from(1_u32 << BITS);
    for reference in [ANY, SINES] {
        let said = first_steps(reference, 0.99 * half_step);
        let refusal = said.iter().position(|step| step.starts_with("NO GAINS: no law"));
        assert_eq!(refusal, Some(1), "{said:?}");
        assert!(said[1].contains(&format!("off by up to {} mrad", milli(half_step))), "{said:?}");
    }
    // No friction: a reading is all that stands in the way of one motion.
    let said = first_steps(SINES, 1.01 * half_step);
    assert!(said.iter().all(|step| !step.contains("NO GAINS")), "{said:?}");
}

#[test]
fn one_motion_has_its_least_error_beside_the_refusal() {
    let half_step = PI / f64::from(1_u32 << BITS);
    let Outcome::Infeasible(no) = outcome(SINES, 0.99 * half_step) else {
        panic!("no law reads finer")
    };
    assert!(no.beyond_any_law, "{no}");
    assert!(
        no.words[0].starts_with("no law that settles within the motion keeps less than"),
        "{no}"
    );
    let possible = no.clauses.iter().filter_map(|clause| clause.possible).fold(0.0, f64::max);
    assert!(possible > half_step, "{no}");
}
