//! A reference from a CSV file: columns are found by name, and every bad row is named.
//!
//! Wrong if a column moves the wrong joint, or if a bad file is read.

use std::path::PathBuf;

use crate::support::{read_in, with_reference};
use phihat_study::{ReferenceRequest, StudyError, StudyErrorKind};

/// A directory of its own with one file in it; removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, bytes: &[u8]) -> Self {
        let path = std::env::temp_dir().join(format!("phihat-study-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("ref.csv"), bytes).unwrap();
        Self(path)
    }

    fn read(&self) -> Result<ReferenceRequest, StudyError> {
        let text = with_reference("[reference]\nkind = 'csv'\nfile = 'ref.csv'\n");
        read_in(&text, &self.0).map(|study| study.reference)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn samples(name: &str, text: &str) -> ReferenceRequest {
    Folder::new(name, text.as_bytes()).read().unwrap_or_else(|error| panic!("{}", error.render()))
}

#[test]
fn columns_are_found_by_name() {
    let expected = ReferenceRequest::Samples {
        t: vec![0.0, 2.5, 5.0],
        q: vec![vec![0.1, 0.2, 0.3], vec![0.2, 0.3, 0.4], vec![0.3, 0.4, 0.5]],
        unread: Vec::new(),
    };
    let plain = "t_s,joint1,joint2,joint3\n0,0.1,0.2,0.3\n2.5,0.2,0.3,0.4\n5,0.3,0.4,0.5\n";
    assert_eq!(samples("plain", plain), expected);
    let moved = "joint3,t_s,joint1,joint2\n0.3,0,0.1,0.2\n0.4,2.5,0.2,0.3\n0.5,5,0.3,0.4";
    assert_eq!(samples("moved", moved), expected);
    // As a spreadsheet writes it: byte-order mark, quotes, blanks, carriage returns, an empty line.
    let office = "\u{feff}\"t_s\", \"joint1\",joint2,joint3\r\n0,1e-1,0.2 ,0.3\r\n2.5,0.2,0.3,0.4\r\n\
                  5,0.3,0.4,0.5\r\n\r\n";
    assert_eq!(samples("office", office), expected);
}

/// `joint_states` of a robot has its gripper too.
#[test]
fn columns_of_no_joint_are_left_out_and_named() {
    let text = "finger,t_s,joint1,joint2,joint3,note\n0.04,0,0.1,0.2,0.3,home\n,2.5,0.2,0.3,0.4,\n0,5,0.3,0.4,0.5,x\n";
    let folder = Folder::new("others", text.as_bytes());
    let study = with_reference("[reference]\nkind = 'csv'\nfile = 'ref.csv'\n");
    let study = read_in(&study, &folder.0).unwrap_or_else(|error| panic!("{}", error.render()));
    let warnings = study.warnings();
    for column in ["`finger`", "`note`"] {
        assert_eq!(warnings.iter().filter(|told| told.contains(column)).count(), 1, "{warnings:?}");
    }
    let ReferenceRequest::Samples { q, unread, .. } = study.reference else { panic!("samples") };
    assert_eq!(
        (q[2].as_slice(), unread),
        (&[0.3, 0.4, 0.5][..], vec!["finger".into(), "note".into()])
    );
    // One that stands in the place of a joint is a slip.
    let slip = text.replace("joint2", "joint_2");
    let error = Folder::new("slip", slip.as_bytes()).read().unwrap_err().render();
    assert!(
        error.contains("no joint `joint_2`") && error.contains("did you mean `joint2`"),
        "{error}"
    );
}

/// A recording of a joint without ends starts over at ±π; what is followed does not.
#[test]
fn a_joint_without_ends_takes_the_near_way() {
    let text = "t_s,axis\n0,3.0\n1,3.1\n2,-3.1\n3,-3.0\n4,3.1\n5,3.0\n";
    let folder = Folder::new("near", text.as_bytes());
    let urdf = r#"<robot name="axis"><link name="base"/>
<joint name="axis" type="continuous"><parent link="base"/><child link="load"/><axis xyz="0 0 1"/>
<limit effort="40" velocity="4"/></joint>
<link name="load"><inertial><mass value="2"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.3"/>
</inertial></link></robot>"#;
    std::fs::write(folder.0.join("axis.urdf"), urdf).unwrap();
    let study = "duration_s = 5.0\n[robot]\nfile = 'axis.urdf'\n[spec]\nsettle_s = 1.0\n[gains]\nbandwidth_rad_s = 10\n\
                 estimator_bandwidth_rad_s = 30\ninertia_kg_m2 = 0.3\n[reference]\nkind = 'csv'\nfile = 'ref.csv'\n";
    let study = read_in(study, &folder.0).unwrap_or_else(|error| panic!("{}", error.render()));
    let ReferenceRequest::Samples { q, .. } = study.reference else { panic!("samples") };
    let turn = core::f64::consts::TAU;
    for (row, wanted) in q.iter().zip([3.0, 3.1, turn - 3.1, turn - 3.0, 3.1, 3.0]) {
        assert!((row[0] - wanted).abs() < 1e-12, "{q:?}");
    }
}

/// A joint that has ends does not turn round: the row is named, and what it looks like.
#[test]
fn a_jump_of_a_whole_turn_is_told_as_such() {
    let text = "t_s,joint1,joint2,joint3\n0,3.1,0.2,0.3\n0.5,-3.1,0.2,0.3\n5,-3.0,0.2,0.3\n";
    let why = Folder::new("turn", text.as_bytes()).read().unwrap_err().to_string();
    assert!(why.contains("joint `joint1`") && why.contains("whole turn"), "{why}");
}

#[test]
fn bad_files_are_refused_at_their_line() {
    let cases: &[(&str, usize, usize, &str)] = &[
        ("", 0, 0, "the file is empty"),
        ("t_s,joint1,joint2,joint3\n", 1, 1, "expected at least 2 rows"),
        ("0,0.1,0.2,0.3\n", 1, 1, "the first line names the columns"),
        ("t_s;joint1;joint2;joint3\n", 1, 1, "separated by commas"),
        ("t_s,joint1,joint2\n0,0,0\n5,0,0\n", 1, 1, "no column `joint3`"),
        ("joint1,joint2,joint3\n0,0,0\n5,0,0\n", 1, 1, "no column `t_s`"),
        ("t_s,joint1,joint2,jiont3\n", 1, 19, "did you mean `joint3`?"),
        ("t_s,joint1,joint2,joint2\n", 1, 19, "column `joint2` appears twice"),
        ("t_s,joint1,joint2,joint3\n0,0,0\n", 2, 1, "3 columns, the first line has 4"),
        ("t_s,joint1,joint2,joint3\n0,0,x,0\n", 2, 5, "`x` is not a number"),
        ("t_s,joint1,joint2,joint3\n0,0,,0\n", 2, 5, "`` is not a number"),
        ("t_s,joint1,joint2,joint3\n0,0,NaN,0\n", 2, 5, "NaN is not a finite number"),
        ("t_s,joint1,joint2,joint3\n0,0,0,1e999\n", 2, 7, "inf is not a finite number"),
        ("t_s,joint1,joint2,joint3\n1,0,0,0\n", 2, 1, "the first sample is at 1 s"),
        ("t_s,joint1,joint2,joint3\n0,0,0,0\n1,0,0,0\n1,0,0,0\n", 4, 1, "1 s is not after"),
        ("t_s,joint1,joint2,joint3\n0,0,4,0\n", 2, 5, "joint `joint2`: 4 is outside"),
        ("t_s,joint1,joint2,joint3\n0,0,0,0\n0.1,0,0,1.5\n", 3, 9, "joint `joint3`: 15.0000 rad/s"),
    ];
    for (i, (text, line, column, fragment)) in cases.iter().enumerate() {
        let error = Folder::new(&format!("bad{i}"), text.as_bytes()).read().unwrap_err();
        let shown = error.to_string();
        assert!(error.file().ends_with("ref.csv"), "{shown}");
        assert_eq!((error.line(), error.column()), (*line, *column), "{shown}");
        assert!(shown.contains(fragment), "`{fragment}` is not in: {shown}");
    }
}

#[test]
fn a_file_that_ends_before_the_run_is_refused() {
    let text = "t_s,joint1,joint2,joint3\n0,0,0,0\n4.9,0,0,0\n";
    let error = Folder::new("short", text.as_bytes()).read().unwrap_err();
    assert_eq!((error.line(), error.key()), (39, "reference.file"));
    assert!(error.message().contains("end at 4.9 s, the run at 5 s"), "{error}");
}

#[test]
fn hostile_files_are_refused() {
    let wide = format!("t_s,{}\n", vec!["j"; 600].join(","));
    for (name, bytes, kind) in [
        ("long", vec![b'1'; 1 << 20], StudyErrorKind::TooLarge),
        ("wide", wide.into_bytes(), StudyErrorKind::TooLarge),
        ("binary", vec![0xff, 0xfe, 0x00], StudyErrorKind::Syntax),
        ("zero", vec![0; 100], StudyErrorKind::WrongLength),
    ] {
        let error = Folder::new(name, &bytes).read().unwrap_err();
        assert_eq!(error.kind(), kind, "{error}");
        assert!(error.render().len() < 1000);
    }
}

const LIMITS: &str =
    "speed_max_rad_s = 1.0\nacceleration_max_rad_s2 = 5.0\njerk_max_rad_s3 = 50.0\n";

/// Rows of setpoints may jump, may end before the run, and may be one; limits are one for all joints or one each.
#[test]
fn setpoints_come_from_a_file_or_from_sections() {
    let text = "t_s,joint1,joint2,joint3\n0,0.1,0.2,0.3\n0.1,0.9,0.3,0.4\n";
    let folder = Folder::new("setpoints", text.as_bytes());
    let from = |reference: &str| {
        let text = format!("[reference]\nkind = 'setpoints'\n{LIMITS}{reference}");
        read_in(&with_reference(&text), &folder.0).map(|study| study.reference)
    };
    let sections = "[[reference.setpoint]]\nt_s = 0\nq_rad = [0.1, 0.2, 0.3]\n[[reference.setpoint]]\nt_s = 0.1\nq_rad \
        = [0.9, 0.3, 0.4]\n";
    let [file, typed] = ["file = 'ref.csv'\n", sections].map(|text| from(text).unwrap());
    assert_eq!(file, typed);
    let ReferenceRequest::Setpoints { t, limits, .. } = file else { panic!("setpoints") };
    assert_eq!((t, limits), (vec![0.0, 0.1], vec![[1.0, 5.0, 50.0]; 3]));
    let both = format!("file = 'ref.csv'\n{sections}");
    for (text, kind) in [
        ("", StudyErrorKind::MissingKey),
        (&both[..], StudyErrorKind::Conflict),
        (&sections.replace("t_s = 0.1", "t_s = 0"), StudyErrorKind::OutOfRange),
        (&sections.replace("t_s = 0\n", "t_s = 0.05\n"), StudyErrorKind::OutOfRange),
        (&sections.replace("[0.1, 0.2, 0.3]", "[9.9, 0.2, 0.3]"), StudyErrorKind::BeyondLimits),
    ] {
        let error = from(text).unwrap_err();
        assert_eq!(error.kind(), kind, "{error}");
    }
}
