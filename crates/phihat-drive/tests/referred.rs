//! A motion from a file in place of the study's. Wrong if another motion were driven, if a joint got
//! another's column, or if a file that is no motion of this arm were driven or left anything.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::support::{HOSTILE, PLAIN, SUPERVISED, folder};
use phihat_drive::{CheckName, DriveOptions, End, State, prepare};
use phihat_session::{Leave, RunOptions};
use phihat_sim::Trace;

/// A file of a second and a half, joints in another order than the arm's.
fn motion(head: &str, second: impl Fn(f64) -> f64) -> String {
    let row = |k: u32| {
        let t = f64::from(k) * 0.025;
        let way = 1.0 - (t * std::f64::consts::TAU / 1.5).cos();
        format!("{t},{},{},{}\n", second(t), 0.6 - 0.02 * way, 0.4 + 0.05 * way)
    };
    format!("{head}\n{}", (0..=60).map(row).collect::<String>())
}

fn options(folder: &Path, study: &str, file: &str) -> DriveOptions {
    fs::write(folder.join("study.toml"), study).unwrap();
    fs::write(folder.join("motion.csv"), file).unwrap();
    let run = RunOptions {
        study: folder.join("study.toml"),
        out: Some(folder.join("out")),
        ..RunOptions::default()
    };
    let (accept, reference) =
        (vec![CheckName::Certificate, CheckName::Window], Some(folder.join("motion.csv")));
    DriveOptions { run, accept, reference, ..DriveOptions::default() }
}

const HEAD: &str = "t_s,joint2,joint3,joint1";

#[test]
fn the_file_is_what_is_driven() {
    let folder = folder("referred");
    // A study whose push and fault come after the file's end.
    for study in [PLAIN.to_owned(), format!("{PLAIN}{SUPERVISED}"), HOSTILE.to_owned()] {
        let options = options(&folder, &study, &motion(HEAD, |_| 1.2));
        let prepared = prepare(&options).unwrap();
        let study = prepared.study().clone();
        let leave = Leave { folder: &folder.join("out"), page: None };
        let driven = prepared.drive(leave, &mut (), &AtomicBool::new(false)).unwrap();
        assert_eq!((driven.tally.end, driven.tally.cycles), (End::Complete, 1500));
        let file = fs::File::open(folder.join("out/trace.parquet")).unwrap();
        let trace = Trace::read(file, &study).unwrap();
        // At a sample of the file; a supervised arm begins a few samples later.
        let at = |joint: usize| trace.joints[joint].q_desired[750];
        assert!((at(0) - 0.5).abs() < 1e-4 && (at(1) - 1.2).abs() < 1e-4, "{} {}", at(0), at(1));
        assert!((at(2) - 0.56).abs() < 1e-4, "{}", at(2));
    }
}

#[test]
fn what_is_no_motion_of_this_arm_is_told_by_its_place() {
    let folder = folder("referred-refused");
    let refused = |file: &str| prepare(&options(&folder, PLAIN, file)).unwrap_err().to_string();
    let good = motion(HEAD, |_| 1.2);
    for (file, says) in [
        (good.replace("joint3", "elbow"), ["motion.csv", "elbow"]),
        (good.replace(",joint1", ""), ["motion.csv", "joint1"]),
        (good.replace("\n0.05,", "\n0.01,"), ["motion.csv:4", "not after"]),
        (good.replace("\n0.05,1.2", "\n0.05,nan"), ["motion.csv:4", "nan"]),
        (motion(HEAD, |t| 1.2 + 2.0 * (9.0 * t).sin()), ["motion.csv:3", "beyond its limit"]),
        (motion(HEAD, |t| 1.2 + 2.0 * t), ["motion.csv", "limit"]),
        (String::new(), ["motion.csv", "empty"]),
    ] {
        let why = refused(&file);
        assert!(says.iter().all(|part| why.contains(part)), "{says:?} not in {why}");
    }
    // More acceleration than the drives have torque for: a check of its own.
    let shaken = motion(HEAD, |t| 1.2 + 0.05 * (120.0 * t).sin());
    let prepared = prepare(&options(&folder, PLAIN, &shaken)).unwrap();
    let check = prepared.checks.iter().find(|check| check.name == CheckName::Motion).unwrap();
    assert_eq!(check.state, State::Failed, "{check:?}");
    assert!(!folder.join("out").exists());
}
