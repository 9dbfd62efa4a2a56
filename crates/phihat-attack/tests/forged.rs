//! Edits of a gains file through the check that `phihat verify` makes, with and without its study: a share of what
//! `cargo xtask forge` does. `PHIHAT_ALL=1`: some thousands.
//! Wrong if an edit passed and printed more than the file did, or if the check panicked.

use std::path::Path;

use phihat_attack::{Forger, ForgeryFate, ForgerySummary};
use phihat_certificate::parallel::shared;
use phihat_study::Study;

const GAINS: &str = include_str!("../../phihat-certificate/tests/forged/two_joints.json");
const STUDY: &str = include_str!("../../phihat-certificate/tests/forged/two_joints.toml");

fn study() -> Study {
    Study::from_text(STUDY, "two_joints.toml", Path::new(".")).unwrap()
}

#[test]
fn no_edit_of_a_gains_file_passes_and_says_more() {
    let (count, every) =
        if std::env::var_os("PHIHAT_ALL").is_some() { (6_000, 4) } else { (500, 10) };
    let forger = Forger::new(GAINS, study(), 7, every).unwrap();
    let records = shared(count, |index| forger.forge(index as u64));
    let refused = records.iter().filter(|own| {
        matches!(own.fate, ForgeryFate::Refused | ForgeryFate::RefusedByStudy | ForgeryFate::Unread)
    });
    assert!(refused.count() > records.len() / 2, "most edits are refused");
    let summary = ForgerySummary::of(Path::new("two_joints.json"), &forger, records, Vec::new());
    println!("{summary}");
    assert!(summary.is_clean(), "{summary}");
}

/// A specification that is not met, and is not listed either.
#[test]
fn a_clause_that_the_bounds_do_not_keep_is_not_proved_whatever_the_file_lists() {
    for (key, value) in [
        ("error_bound_rad", "1e-5"),
        ("velocity_error_bound_rad_s", "1e-4"),
        ("tip_error_bound_mm", "1e-3"),
    ] {
        let line = format!("{key} = {value}");
        let mut lines: Vec<&str> = STUDY.lines().filter(|line| !line.starts_with(key)).collect();
        let spec = lines.iter().position(|line| *line == "[spec]").unwrap();
        lines.insert(spec + 1, &line);
        let text = lines.join("\n");
        let study = Study::from_text(&text, "two_joints.toml", Path::new(".")).unwrap();
        let mut gains = phihat_certificate::Gains::from_json(GAINS).unwrap();
        gains.study_sha256.clone_from(&study.sha256);
        let subject =
            phihat_session::Checked::Documents { gains: &gains, study: Some(&study), seed: 0 };
        let verified = phihat_session::verify(subject, &|_| ()).unwrap().claims.unwrap().unwrap();
        assert_eq!(verified.verdict, phihat_certificate::Verdict::NotProved, "{key}");
        let listed = verified.not_proved.iter().any(|line| line.contains(key));
        assert!(listed, "{key}: {:?}", verified.not_proved);
    }
}
