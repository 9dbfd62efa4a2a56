//! Faults are read as they are written, and refused where they cannot be. Wrong if a fault could act on
//! another joint, at another time or by another amount than its file says.

use crate::support::{GOOD, read};
use phihat_study::{Fault, FaultKind};

fn with(fault: &str) -> String {
    GOOD.replace("[reference]", &format!("[[fault]]\n{fault}\n[reference]"))
}

#[test]
fn every_kind_is_read() {
    for kind in FaultKind::ALL {
        let joint = if kind.per_joint() { "joint = \"joint2\"" } else { "" };
        let bare = format!("kind = \"{}\"\nstart_s = 1.5\nduration_s = 0.25\n{joint}", kind.word());
        let study =
            read(&with(&format!("{bare}\nsize = 1"))).or_else(|_| read(&with(&bare))).unwrap();
        let joint = kind.per_joint().then_some(1);
        let expected = Fault { kind: *kind, start: 1.5, duration: 0.25, joint, size: 1.0 };
        assert_eq!(study.faults, [expected]);
    }
    assert!(read(GOOD).unwrap().faults.is_empty());
}

#[test]
fn without_joint_and_duration_it_is_everywhere_and_to_the_end() {
    let study = read(&with("kind = \"drive_gain\"\nstart_s = 2\nsize = 0.5")).unwrap();
    let fault = &study.faults[0];
    assert!((0..3).all(|joint| fault.concerns(joint)));
    assert!(!fault.active(1.999) && fault.active(2.0) && fault.active(1e9));
}

#[test]
fn what_cannot_be_is_refused_at_its_key() {
    let cases = [
        ("kind = \"drive_gian\"\nstart_s = 1", "fault[0].kind", "drive_gain"),
        ("kind = \"drive_gain\"\nstart_s = 1", "fault[0].size", "takes a size"),
        ("kind = \"drive_gain\"\nstart_s = 1\nsize = 11", "fault[0].size", "-10 to 10"),
        ("kind = \"sensor_nan\"\nstart_s = 1\nsize = 2", "fault[0].size", "has no size"),
        ("kind = \"joint_order\"\nstart_s = 1\nsize = 1.5", "fault[0].size", "integer"),
        (
            "kind = \"payload\"\nstart_s = 1\nsize = 1\njoint = \"joint2\"",
            "fault[0].joint",
            "whole arm",
        ),
        ("kind = \"brake\"\nstart_s = 1\nsize = 1\njoint = \"joint9\"", "fault[0].joint", "joint9"),
        ("kind = \"brake\"\nstart_s = 5\nsize = 1", "fault[0].start_s", "before the end"),
        ("kind = \"brake\"\nsize = 1", "fault[0].start_s", "missing"),
        ("kind = \"brake\"\nstart_s = 1\nduration_s = 0\nsize = 1", "fault[0].duration_s", "range"),
    ];
    for (text, key, says) in cases {
        let error = read(&with(text)).unwrap_err();
        assert_eq!(error.key(), key, "{error}");
        assert!(error.to_string().contains(says), "{error}");
    }
}
