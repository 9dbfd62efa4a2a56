//! Keys under the names of earlier versions.
//!
//! Wrong if an old name were read as another value, or not, if both names could stand, or if a rewritten study had
//! lost a comment, an order or a value.

use std::path::Path;

use phihat_study::{Study, StudyErrorKind};

use crate::support::{GOOD, read};

const OLD: [(&str, &str); 4] = [
    ("error_max_rad", "error_bound_rad"),
    ("error_integral_max_rad_s", "error_integral_bound_rad_s"),
    ("velocity_error_max_rad_s", "velocity_error_bound_rad_s"),
    ("tip_error_max_mm", "tip_error_bound_mm"),
];

/// The good study, whose specification these lines are.
fn with_spec(lines: &str) -> String {
    GOOD.replace("settle_s = 1.0\nerror_bound_rad = 1e-3\n", lines)
}

#[test]
fn every_old_name_is_read_as_its_new_one() {
    let all = |pick: fn(&(&str, &str)) -> String| OLD.iter().map(pick).collect::<String>();
    let old = with_spec(&all(|(old, _)| format!("{old} = 0.25 # of old\n")));
    let new = with_spec(&all(|(_, new)| format!("{new} = 0.25 # of old\n")));
    let (old, new) = (read(&old).unwrap(), read(&new).unwrap());
    assert_eq!(old.spec, new.spec);
    assert!(new.spec.error_bound.is_some() && new.spec.tip_error_bound.is_some());
    assert_eq!((old.renamed.len(), new.renamed.len()), (4, 0));
    assert_eq!(old.rewritten().as_ref(), Some(&new.text));
    assert_eq!(new.rewritten().as_ref(), Some(&new.text));
    assert_eq!(old.table().unwrap(), new.text.parse().unwrap());
    assert_ne!(old.sha256, new.sha256, "the sum is that of the file as it is");
    let line = old.renamed[0].to_string();
    let said = "studies/base.toml:9: spec.error_max_rad is called spec.error_bound_rad now";
    assert!(line.starts_with(said), "{line}");
    assert_eq!(old.renamed[3].line(), 12);
}

#[test]
fn comments_order_and_ways_of_writing_stay() {
    let pairs = [
        (
            "# first\nsettle_s = 1.0 # second\n\"error_max_rad\" = [1e-3, # third\n  2e-3, 3e-3]\n",
            "# first\nsettle_s = 1.0 # second\nerror_bound_rad = [1e-3, # third\n  2e-3, 3e-3]\n",
        ),
        (
            "error_max_rad = { joint1 = 1e-3, joint2 = 1e-3, joint3 = 2e-3 } # error_max_rad\n",
            "error_bound_rad = { joint1 = 1e-3, joint2 = 1e-3, joint3 = 2e-3 } # error_max_rad\n",
        ),
    ];
    for (before, after) in pairs {
        assert_eq!(read(&with_spec(before)).unwrap().rewritten(), Some(with_spec(after)));
    }
    let joint = |i: u8| format!("error_max_rad.joint{i} = {i}e-3\n");
    let study = read(&with_spec(&[1, 2, 3].map(joint).concat())).unwrap();
    assert_eq!(study.spec.error_bound, Some(vec![1e-3, 2e-3, 3e-3]));
    assert_eq!(study.rewritten(), None, "one key at three places");
    assert!(study.table().unwrap()["spec"]["error_bound_rad"].is_table());
    let dotted = GOOD.replace("[spec]\nsettle_s = 1.0\nerror_bound_rad = 1e-3\n", "");
    let dotted = format!("spec.error_max_rad = 1e-3 # dotted\n{dotted}");
    let study = read(&dotted).unwrap();
    let text = study.rewritten().unwrap();
    assert!(text.starts_with("spec.error_bound_rad = 1e-3 # dotted\n"));
    assert_eq!(read(&text).unwrap().spec, study.spec);
}

#[test]
fn both_names_are_refused_at_the_old_one() {
    for (old, new) in OLD {
        let text = with_spec(&format!("{new} = 0.25\n{old} = 0.25\n"));
        let error = read(&text).unwrap_err();
        assert_eq!(error.kind(), StudyErrorKind::Conflict, "{error}");
        assert_eq!((error.key(), error.line()), (format!("spec.{old}").as_str(), 10));
        assert!(error.help().unwrap().ends_with(&format!("keep `{new}`")), "{error}");
        let all = Study::check_text(&text, "studies/base.toml", Path::new("")).unwrap_err();
        assert_eq!(all.len(), 1, "{all:?}");
    }
}

#[test]
fn a_value_under_an_old_name_is_checked_as_under_the_new_one() {
    let error = read(&with_spec("error_max_rad = -1.0\n")).unwrap_err();
    assert_eq!((error.kind(), error.line()), (StudyErrorKind::OutOfRange, 9));
    assert_eq!(error.key(), "spec.error_bound_rad");
    // An old name is known in its section only.
    let error = read(&GOOD.replace("rate_hz = 1000.0", "error_max_rad = 1.0")).unwrap_err();
    assert_eq!(error.kind(), StudyErrorKind::UnknownKey);
}
