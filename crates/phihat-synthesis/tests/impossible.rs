//! A class of motions with an error that no law keeps: refused, with one that can be asked for. Wrong if an error below
//! half a step of the encoder is searched for, if one above is refused by this inequality, if a design for the error
//! that is offered misses it by more than a tenth, or if a design's bound is below the encoder's half step.

use core::f64::consts::PI;
use std::path::Path;

use phihat_design::Outcome;
use phihat_study::Study;
use phihat_synthesis::{Recordings, SynthesisOptions, arm_along, synthesize};

/// Bits of the encoders.
const BITS: u8 = 20;

/// Three joints in a plane without friction, any motion, and an error bound \[rad\].
fn outcome(error_rad: f64) -> Outcome {
    let text = format!(
        "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 1.0\nerror_bound_rad = {error_rad:e}\n\
         [design]\npayload_max_kg = 0.05\ntorque_step_max_nm = 1.0\nwindow_margin = 1.1\norders = [1]\n[loop]\n\
         delay_samples = 1\nform = \"positions\"\n[sensor]\nencoder_bits = {BITS}\n[start]\ntorque_nm = \
         \"balance\"\n[reference]\nkind = \"any\"\ncenter = \"ready\"\nbox_rad = 0.2\nspeed_max_rad_s = \
         0.2\nacceleration_max_rad_s2 = 0.5\njerk_max_rad_s3 = 5.0\n"
    );
    let study = Study::from_text(&text, "arm.toml", Path::new("."));
    let study = study.unwrap_or_else(|e| panic!("{e}\n{text}"));
    let arm = arm_along(&study).unwrap();
    synthesize(&study, &arm, &Recordings::default(), SynthesisOptions::default()).unwrap()
}

#[test]
fn an_error_that_no_law_keeps_is_refused_with_one_that_a_design_reaches() {
    let half_step = PI / f64::from(1_u32 << BITS);
    let Outcome::Infeasible(no) = outcome(0.99 * half_step) else { panic!("no law reads finer") };
    assert!(no.beyond_any_law, "{no}");
    assert_eq!(no.clauses.len(), 3, "{no}");
    assert!(no.words[0].contains(&format!("{half_step:.3e} rad (encoder step")), "{no}");
    let possible: Vec<f64> = no.clauses.iter().filter_map(|clause| clause.possible).collect();
    assert_eq!(possible.len(), 3, "{no}");
    let most = possible.iter().copied().fold(0.0, f64::max);
    // What is offered, "about", is reached, by a bound that is wider than a half step.
    let Outcome::Designed(gains) = outcome(most) else { panic!("{most} is possible") };
    let certificate = gains.certificate.as_ref().unwrap();
    let class = certificate.class.as_ref().unwrap();
    for bound in &class.error_bound_rad {
        assert!((half_step..=1.1 * most).contains(bound), "{bound} {half_step} {most}");
    }
}
