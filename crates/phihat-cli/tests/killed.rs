//! A drive whose process is killed by the system. Wrong if more than the last second were lost of what had
//! been driven, if a sample that is read back were another than the one that acted, if an older record were
//! touched before, or if the remaining journal were not reported.
#![cfg(unix)]

use std::fs;
use std::net::Ipv4Addr;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use crate::support::{Files, Running, files_of, folder, leave, phihat, small, wait_for};
use phihat_fci::{
    Ending, FciError, Host, Pace, Packets, RobotRules, RobotSide, StateSensed, World,
};
use phihat_session::{LOST_MAX_S, recorded};
use phihat_sim::Stepped;

/// A Panda that a supervisor guards.
const STUDY: &str = r#"
title = "A drive that is killed"
duration_s = 20.0
[robot]
name = "panda"
[profile]
name = "robot"
[spec]
settle_s = 1.0
error_bound_rad = 0.5
[gains]
order = 2
bandwidth_rad_s = 20.0
estimator_bandwidth_rad_s = 50.0
inertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]
[loop]
rate_hz = 1000.0
delay_samples = 1
[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 45.0
[supervisor]
error_stop_rad = 0.5
[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0
[[reference.sine]]
amplitude_rad = 0.1
frequency_hz = 0.5
"#;

/// The arm behind Franka's interface, no faster than its clock; what acted, and how often.
struct Robot {
    run: Stepped,
    steps: Arc<AtomicUsize>,
    torques: Arc<Mutex<Vec<[f64; 7]>>>,
    ended: bool,
}

impl World for Robot {
    type Error = FciError;

    fn begin(&mut self) -> Result<(), FciError> {
        Ok(())
    }

    fn sensed(&mut self) -> StateSensed {
        let mut sensed = StateSensed { arrives: true, ..StateSensed::default() };
        for (i, joint) in self.run.sensed().iter().enumerate() {
            (sensed.q[i], sensed.dq[i]) = (joint.q, joint.dq);
            sensed.tau_j_d[i] = self.run.accepted()[i];
        }
        sensed
    }

    fn step(&mut self, torque: &[f64; 7]) {
        self.run.step(torque).unwrap();
        self.torques.lock().unwrap().push(*torque);
        self.steps.fetch_add(1, Ordering::SeqCst);
        thread::sleep(Duration::from_millis(1));
    }

    fn is_over(&self) -> bool {
        self.run.is_over()
    }

    fn ended(&mut self, _: Ending, _: Packets) -> Result<(), FciError> {
        self.ended = true;
        Ok(())
    }

    fn is_done(&mut self) -> bool {
        self.ended
    }
}

/// Drives it, and kills the process once so many samples acted; every torque that acted.
fn killed_after(folder: &Path, samples: usize) -> Vec<[f64; 7]> {
    let study = phihat_session::read(&folder.join("study.toml")).unwrap();
    let gains = phihat_design::requested_gains(&study).unwrap();
    let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let (steps, torques) = (Arc::new(AtomicUsize::new(0)), Arc::default());
    let run = Stepped::in_blocks(&study, &inertia).unwrap();
    let mut robot =
        Robot { run, steps: Arc::clone(&steps), torques: Arc::clone(&torques), ended: false };
    let pace = Pace::LockStep { patience: Duration::from_mins(1) };
    let side = RobotSide::new(RobotRules::NONE, String::new());
    let mut host = Host::listen(Ipv4Addr::LOCALHOST.into(), 0, pace, side).unwrap();
    let on = format!("fci://{}?protocol=5", host.address());
    let serving = thread::spawn(move || host.serve(&mut robot).unwrap());
    let mut line = vec!["drive", "study.toml", "--on", &on, "--out", "out"];
    for check in ["certificate", "profile", "real-time", "rehearsal"] {
        line.extend(["--accept", check]);
    }
    let mut running = Running::of(folder, &line, None);
    let acted = || steps.load(Ordering::SeqCst) >= samples;
    if !running.until("so many samples acted", acted) {
        let answer = running.answer();
        panic!("it ended before: {}{}", answer.out, answer.err);
    }
    assert!(running.kill());
    wait_for("the robot sees it", || serving.is_finished());
    serving.join().unwrap();
    std::mem::take(&mut *torques.lock().unwrap())
}

fn refused(folder: &Path, line: &[&str], words: &str) {
    let answer = phihat(folder, line);
    assert_eq!(answer.code, 2, "{line:?}: {}{}", answer.out, answer.err);
    assert!(answer.err.contains(words), "{line:?}: {}", answer.err);
}

const HOW: &str = "`phihat report --recover out` makes its record";

#[test]
fn what_was_driven_up_to_a_kill_can_be_read_back_but_for_the_last_second() {
    let folder = folder("killed");
    fs::write(folder.join("study.toml"), STUDY).unwrap();
    fs::write(folder.join("small.toml"), small("older", 0.1, 5.0)).unwrap();
    let kills: usize = std::env::var("PHIHAT_KILLS").map_or(3, |n| n.parse().unwrap());
    let mut most = 0;
    for kill in 0..kills {
        // Over no record first, then over an older one.
        let older = kill > 0;
        if older {
            assert_eq!(phihat(&folder, &["run", "small.toml", "--out", "out"]).code, 0);
        }
        let before = if older { record_in(&folder.join("out")) } else { Files::new() };
        let torques = killed_after(&folder, 700 + 397 * (kill % 7));
        assert!(record_in(&folder.join("out")) == before, "an older record was touched");
        let mut left = files_of(&folder.join("out"));
        left.retain(|name, _| name.starts_with("unfinished"));
        assert!(left.len() >= 4, "{:?}", left.keys());
        // It is told of, and nothing drives over it.
        let report = phihat(&folder, &["report", "out"]);
        assert_eq!(report.code, if older { 0 } else { 2 }, "{}", report.err);
        assert!(report.err.contains(HOW), "{}", report.err);
        refused(&folder, &["drive", "small.toml", "--accept", "certificate", "--out", "out"], HOW);
        let now = files_of(&folder.join("out"));
        assert!(left.iter().all(|(name, bytes)| now.get(name) == Some(bytes)));
        let recovered = phihat(&folder, &["report", "--recover", "out"]);
        assert_eq!(recovered.code, 0, "{}", recovered.err);
        let (done, trace) = recorded(&folder.join("out")).unwrap();
        let lost = torques.len().saturating_sub(trace.len());
        most = most.max(lost);
        assert!(lost as f64 * 1e-3 <= LOST_MAX_S, "{lost} of {} samples", torques.len());
        assert!(trace.len() <= torques.len() + 1 && trace.supervision.is_some());
        for (k, torque) in torques.iter().take(trace.len()).enumerate() {
            for (joint, tau) in trace.joints.iter().zip(torque) {
                assert_eq!(joint.tau_command[k].to_bits(), tau.to_bits(), "{k}: {}", joint.name);
            }
        }
        let until = format!("killed at t = {:.3} s", trace.len() as f64 * 1e-3);
        assert!(done.run.warnings.iter().any(|line| line.contains(&until)), "{:?}", done.run);
        let drive = fs::read_to_string(folder.join("out/drive.json")).unwrap();
        assert!(drive.contains(r#""end": "killed""#) && drive.contains(r#""on": "--on fci://"#));
        assert_eq!(phihat(&folder, &["verify", "--run", "out"]).code, 0);
        assert!(!folder.join("out/unfinished").exists());
        refused(&folder, &["report", "--recover", "out"], "there is nothing to recover");
        fs::remove_dir_all(folder.join("out")).unwrap();
    }
    println!("{kills} kills: at most {most} samples of 1 ms lost");
}

/// The files of a record, without what stands beside them on the way.
fn record_in(folder: &Path) -> Files {
    let mut all = files_of(folder);
    all.retain(|name, _| !is_partial(name) && !name.starts_with("unfinished"));
    all.remove(Path::new(".phihat.lock"));
    all
}

fn is_partial(name: &Path) -> bool {
    name.to_str().unwrap().ends_with(".partial")
}

/// Killed at every operation on the disk, in turn (with `PHIHAT_ALL=1`; else at the first three and at one in
/// five), over an older record, with a file that the study names.
#[cfg(debug_assertions)]
#[test]
fn a_drive_killed_at_the_disk_leaves_an_older_record_or_its_own_or_what_makes_one() {
    let folder = folder("killed-at-the-disk");
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../phihat-model/robots");
    for name in ["planar3r.urdf", "planar3r.toml"] {
        fs::copy(robots.join(name), folder.join(name)).unwrap();
    }
    let named = small("new", 0.2, 4.0).replace("name = \"planar3r\"", "file = \"planar3r.toml\"");
    // Two parts of a quarter of a second, and some.
    fs::write(folder.join("new.toml"), named.replace("duration_s = 0.05", "duration_s = 0.6"))
        .unwrap();
    fs::write(folder.join("old.toml"), small("old", 0.3, 5.0)).unwrap();
    assert_eq!(phihat(&folder, &["run", "old.toml", "--out", "out"]).code, 0);
    let out = folder.join("out");
    let results = || record_in(&out);
    let (before, old) = (files_of(&out), results());
    let line = ["drive", "new.toml", "--accept", "certificate", "--out", "out"];
    let clean = phihat(&folder, &line);
    assert!(clean.code < 2, "{}", clean.err);
    let new = results();
    let whole = recorded(&out).unwrap().1;
    assert!(new.keys().any(|name| name.starts_with("inputs")), "{:?}", new.keys());
    assert!(!out.join("unfinished").exists());
    let every = std::env::var_os("PHIHAT_ALL").is_some();
    let (mut kept, mut operations) = (0, 0);
    for number in (1..).filter(|number| every || *number < 4 || number % 5 == 0) {
        leave(&out, &before);
        let mut running = Running::of(&folder, &line, Some(&format!("kill {number}")));
        if !running.is_struck() {
            break;
        }
        drop(running);
        operations = number;
        let now = results();
        assert!(
            now == old || now == new || !now.contains_key(Path::new("run.json")),
            "kill {number}: a mixture: {:?}",
            now.keys()
        );
        let again = phihat(&folder, &line);
        if again.err.contains(HOW) {
            assert_eq!(again.code, 2, "{}", again.err);
            let recovered = phihat(&folder, &["report", "--recover", "out"]);
            assert_eq!(recovered.code, 0, "kill {number}: {}", recovered.err);
            let (_, trace) = recorded(&out).unwrap();
            let same = whole.joints[0].q.starts_with(&trace.joints[0].q);
            assert!(same && (1..=600).contains(&trace.len()), "kill {number}: {}", trace.len());
            kept += 1;
            assert_eq!(phihat(&folder, &["verify", "--run", "out"]).code, 0, "kill {number}");
            assert_eq!(phihat(&folder, &line).code, clean.code);
        } else {
            assert_eq!(again.code, clean.code, "kill {number}: {}", again.err);
        }
        assert!(results() == new, "kill {number}: other bytes when it is driven again");
        let left: Vec<_> = files_of(&out).into_keys().filter(|name| is_partial(name)).collect();
        assert!(left.is_empty() && !out.join("unfinished").exists(), "kill {number}: {left:?}");
    }
    println!("drive: {operations} operations, a record made of what was left at {kept} of them");
    assert!(operations > 50 && kept > 5, "{operations} operations, {kept} records");
}

/// Whatever byte a kill cut the trace off at, the samples before it are those of the drive.
#[test]
fn a_trace_that_is_cut_anywhere_is_read_up_to_its_last_whole_sample() {
    let folder = folder("killed-cut");
    fs::write(folder.join("small.toml"), small("cut", 0.2, 4.0)).unwrap();
    let line = ["drive", "small.toml", "--accept", "certificate", "--out", "out", "--csv"];
    assert_eq!(phihat(&folder, &line).code, 0);
    let whole = fs::read(folder.join("out/trace.csv")).unwrap();
    let out = folder.join("out");
    fs::remove_dir_all(&out).unwrap();
    let mut running = Running::of(&folder, &line, Some("kill 1 unfinished/trace.csv"));
    assert!(running.is_struck());
    drop(running);
    let before = files_of(&out);
    assert!(before.contains_key(Path::new("unfinished/begun.json")), "{:?}", before.keys());
    let lines = |bytes: &[u8]| bytes.split(|byte| *byte == b'\n').count() - 1;
    let head = whole.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    for cut in [whole.len(), whole.len() - 1, head + 1000, whole.len() / 2, whole.len() / 3] {
        leave(&out, &before);
        fs::write(out.join("unfinished/trace.csv"), &whole[..cut]).unwrap();
        let recovered = phihat(&folder, &["report", "--recover", "out"]);
        assert_eq!(recovered.code, 0, "{cut}: {}", recovered.err);
        let found = fs::read(out.join("trace.csv")).unwrap();
        assert!(whole.starts_with(&found) && lines(&found) == lines(&whole[..cut]), "{cut}");
    }
    // Not one sample: nothing is made of it, and it stays.
    leave(&out, &before);
    fs::write(out.join("unfinished/trace.csv"), &whole[..head + 9]).unwrap();
    refused(&folder, &["report", "--recover", "out"], "unfinished/trace.csv");
    // Not the gains that ran.
    fs::write(out.join("unfinished/trace.csv"), &whole).unwrap();
    fs::write(out.join("unfinished/gains.json"), "{}").unwrap();
    refused(&folder, &["report", "--recover", "out"], "unfinished/gains.json: is not the file");
    assert!(out.join("unfinished/trace.csv").exists());
    // What is somebody else's is not taken away.
    fs::remove_file(out.join("unfinished/begun.json")).unwrap();
    fs::write(out.join("unfinished/notes.txt"), "mine").unwrap();
    refused(&folder, &line, "unfinished: notes.txt is there");
    assert!(out.join("unfinished/notes.txt").exists());
}
