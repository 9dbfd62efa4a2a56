//! Studies and records of earlier versions, whose error bounds have other names.
//!
//! Wrong if such a study were refused, read without a word, or rewritten with a loss; or if such a record did not
//! verify.

use std::fs;

use phihat_session::sha256;

use crate::support::{folder, phihat};

/// A study under the names of before.
const OLD: &str = "duration_s = 0.3 # short\n[robot]\nname = \"planar3r\"\n\n# what is asked\n[spec]\nsettle_s = 0.1\n\
                   error_max_rad = 0.05      # on every joint\n[gains]\norder = 1\nbandwidth_rad_s = 20.0\n\
                   estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = 0.3\n[reference]\nkind = \"hold\"\npose = \
                   \"ready\"\n";

#[test]
fn a_study_of_before_runs_with_a_warning_and_is_rewritten_in_place() {
    let folder = folder("renamed-study");
    fs::write(folder.join("old.toml"), OLD).unwrap();
    let line = "warning: old.toml:8: spec.error_max_rad is called spec.error_bound_rad now";
    let told = |err: &str| err.matches(line).count();
    let run = phihat(&folder, &["simulate", "old.toml"]);
    assert_eq!((run.code, told(&run.err)), (0, 1), "{}", run.err);
    let checked = phihat(&folder, &["check", "old.toml"]);
    assert_eq!((checked.code, told(&checked.err)), (0, 1), "{}", checked.err);
    assert_eq!(fs::read_to_string(folder.join("old.toml")).unwrap(), OLD, "nobody asked for it");

    let rewritten = phihat(&folder, &["check", "--rewrite", "old.toml"]);
    assert_eq!((rewritten.code, told(&rewritten.err)), (0, 0), "{}", rewritten.err);
    let said = "old.toml:8: spec.error_max_rad renamed to spec.error_bound_rad";
    assert!(rewritten.out.contains(said), "{}", rewritten.out);
    let text = fs::read_to_string(folder.join("old.toml")).unwrap();
    assert_eq!(text, OLD.replace("error_max_rad", "error_bound_rad"));
    let again = phihat(&folder, &["check", "--rewrite", "--json", "old.toml"]);
    let answer: serde_json::Value = serde_json::from_str(&again.out).unwrap();
    assert_eq!(answer["studies"][0]["renamed"], serde_json::json!([]));
    assert_eq!(fs::read_to_string(folder.join("old.toml")).unwrap(), text);
}

#[test]
fn a_study_that_cannot_be_rewritten_stays_as_it_is() {
    let folder = folder("renamed-refused");
    let value = "error_max_rad = 0.05      # on every joint\n";
    let both = OLD.replace(value, &format!("{value}error_bound_rad = 0.05\n"));
    let parts = [1, 2, 3].map(|i| format!("error_max_rad.joint{i} = 0.05\n")).concat();
    for (text, why) in
        [(both, "keep `error_bound_rad`"), (OLD.replace(value, &parts), "rename it there")]
    {
        fs::write(folder.join("old.toml"), &text).unwrap();
        let refused = phihat(&folder, &["check", "--rewrite", "old.toml"]);
        assert_eq!(refused.code, 2, "{}", refused.out);
        assert!(refused.err.contains(why), "{}", refused.err);
        assert_eq!(fs::read_to_string(folder.join("old.toml")).unwrap(), text);
    }
}

#[test]
fn a_record_of_before_verifies() {
    let folder = folder("renamed-record");
    fs::write(folder.join("old.toml"), OLD).unwrap();
    assert_eq!(phihat(&folder, &["simulate", "old.toml"]).code, 0);
    let (metrics, run) = (folder.join("out/old/metrics.json"), folder.join("out/old/run.json"));
    let new = fs::read_to_string(&metrics).unwrap();
    let old = new.replace("error_peak_rad", "error_max_rad");
    let old = old.replace("\"error_bound_rad", "\"error_spec_rad");
    assert_ne!(old, new);
    let sum = |text: &str| sha256(&mut text.as_bytes()).unwrap();
    let text = fs::read_to_string(&run).unwrap().replace(&sum(&new), &sum(&old));
    fs::write(&run, text).unwrap();
    fs::write(&metrics, old).unwrap();
    let good = phihat(&folder, &["verify", "--run", "out/old"]);
    assert_eq!(good.code, 0, "{}{}", good.out, good.err);
    assert!(good.out.contains("its figures follow from its trace"), "{}", good.out);
}
