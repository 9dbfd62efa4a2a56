//! A synthesis begins with data that it was given, and says which it lacks.
//! Wrong if a study that names a recording were designed without it, or if a motion beyond the drives passed unasked.

use std::path::{Path, PathBuf};

use phihat_study::{InertiaSource, PhiSource, Study};
use phihat_synthesis::{Recordings, SynthesisError, SynthesisOptions, arm, synthesize};

fn study(rest: &str) -> Study {
    let text = format!(
        "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 1.0\nerror_bound_rad = \
         0.02\n[loop]\n{rest}\n[design]\norders = [1]\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = \
         1.0\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.3\n"
    );
    Study::from_text(&text, "arm.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

#[test]
fn a_recording_that_was_not_read_is_named() {
    let (mut study, none) = (study(""), Recordings::default());
    let described = arm(&study, &none).unwrap();
    study.design.phi = PhiSource::Trace(PathBuf::from("run.csv"));
    let options = SynthesisOptions::default();
    let why = synthesize(&study, &described, &none, options).unwrap_err();
    assert!(matches!(&why, SynthesisError::Recording(file) if file.ends_with("run.csv")), "{why}");
    study.design.inertia = InertiaSource::Trace(PathBuf::from("moved.csv"));
    let why = arm(&study, &none).unwrap_err();
    assert_eq!(why.file(), Some(Path::new("moved.csv")), "{why}");
}

#[test]
fn a_motion_beyond_the_drives_is_an_error_unless_it_is_accepted() {
    // Gravity alone needs more than a newton metre.
    let (study, none) = (study("torque_max_nm = 1.0"), Recordings::default());
    let described = arm(&study, &none).unwrap();
    let why = synthesize(&study, &described, &none, SynthesisOptions::default()).unwrap_err();
    assert!(matches!(why, SynthesisError::Overload(_)), "{why}");
    let accepted = SynthesisOptions { beyond_drives: true, ..SynthesisOptions::default() };
    let outcome = synthesize(&study, &described, &none, accepted);
    assert!(!matches!(outcome, Err(SynthesisError::Overload(_))));
}
