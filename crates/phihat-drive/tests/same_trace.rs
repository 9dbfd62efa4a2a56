//! A drive on the simulated arm in lock-step is the simulation, whatever the world does to the loop. Wrong if
//! a bit of its trace or a figure differed from those of the loop that simulates in one go, which shares
//! neither link, ring nor thread with it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use crate::support::{HOSTILE, PLAIN, SUPERVISED, folder, sides};
use phihat_drive::{CheckName, DriveOptions, End, On, SimLink, prepare, prepare_on};
use phihat_session::{Leave, RunOptions, RunRecord};
use serde_json::json;

/// Runs and drives a study; returns the number of lost samples.
fn same(study: &Path, on: On) -> u64 {
    let out = study.with_extension("out");
    let run = RunOptions {
        study: study.to_owned(),
        out: Some(out.clone()),
        uncertified: true,
        ..RunOptions::default()
    };
    let (done, trace) = run.open().unwrap().0.run(|_| ());
    let mut file = Vec::new();
    trace.write_parquet(&mut file).unwrap();
    let options =
        DriveOptions { run, on, accept: CheckName::ALL.to_vec(), ..DriveOptions::default() };
    let leave = Leave { folder: &out, page: None };
    let driven = prepare(&options).unwrap().drive(leave, &mut (), &AtomicBool::new(false)).unwrap();
    let name = study.display();
    assert!(fs::read(out.join("trace.parquet")).unwrap() == file, "{name}: the traces differ");
    let figures = |figures| format!("{figures:#}");
    assert_eq!(figures(driven.done.figures()), figures(done.figures()), "{name}");
    assert_eq!(driven.done.verdict(), done.verdict(), "{name}");
    let (divergence, abort) = (&driven.done.divergence, &driven.done.abort);
    assert_eq!((divergence, abort), (&done.divergence, &done.abort), "{name}");
    let end = if done.abort.is_some() || done.divergence.is_some() { "fault" } else { "complete" };
    let over = matches!(driven.tally.end, End::Over | End::Fault(_));
    assert_eq!(over, end == "fault", "{name}: {:?}", driven.tally.end);
    // And it reads back as a record.
    let read = RunRecord::read(&out.join("trace.parquet")).unwrap();
    assert_eq!(json!(read.seen.metrics), json!(done.metrics), "{name}");
    driven.tally.lost
}

/// A study of the repository, shortened.
fn shipped(folder: &Path, name: &str, duration_s: f64) -> PathBuf {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    let text = fs::read_to_string(studies.join(name)).unwrap();
    let line = text.lines().find(|line| line.starts_with("duration_s")).unwrap();
    let path = folder.join(name);
    fs::write(&path, text.replacen(line, &format!("duration_s = {duration_s:?}"), 1)).unwrap();
    path
}

#[test]
fn shipped_studies_are_driven_as_they_are_simulated() {
    let folder = folder("shipped");
    let studies = [
        ("first.toml", 5.0, false),
        ("franka.toml", 2.5, true),
        ("estop_restart.toml", 10.0, false),
        ("sensor_freeze.toml", 3.5, false),
        ("payload_drop.toml", 5.5, false),
        ("weak_drive.toml", 4.0, false),
        ("stiction.toml", 3.0, false),
    ];
    let few = if std::env::var_os("PHIHAT_ALL").is_some() { 7 } else { 3 };
    for (name, duration_s, lossy) in studies.into_iter().take(few) {
        let lost = same(&shipped(&folder, name, duration_s), On::Sim);
        assert_eq!(lost > 0, lossy, "{name}: {lost} samples lost");
    }
}

#[test]
fn hostile_worlds_are_driven_as_they_are_simulated() {
    let folder = folder("hostile");
    let literal = HOSTILE
        .replace("delay_samples = 1\n[sensor]", "delay_samples = 0\nform = \"literal\"\n[sensor]");
    assert!(literal != HOSTILE);
    let aborted = format!("{HOSTILE}[profile]\nname = \"franka\"\ncontroller_keeps = false\n");
    let diverged = HOSTILE.replace("bandwidth_rad_s = 15.0", "bandwidth_rad_s = 300.0");
    for (name, text, lossy) in [
        ("bare", HOSTILE.to_owned(), true),
        ("supervised", format!("{HOSTILE}{SUPERVISED}"), true),
        ("literal", literal, true),
        ("aborted", aborted, false),
        ("diverged", diverged, true),
    ] {
        let path = folder.join(format!("{name}.toml"));
        fs::write(&path, text).unwrap();
        let lost = same(&path, On::Sim);
        assert!(lost > 0 || !lossy, "{name}: nothing was lost");
    }
}

/// A law from positions, which the design finds.
#[test]
fn a_law_from_positions_is_driven_as_it_is_simulated() {
    let folder = folder("positions");
    let text = r#"
duration_s = 1.5
[robot]
name = "planar3r"
locked = { joint2 = 0.5, joint3 = 0.5 }
[spec]
error_bound_rad = 4e-3
[design]
[loop]
form = "positions"
torque_rate_max_nm_s = "none"
[sensor]
encoder_bits = 18
[start]
torque_nm = "gravity"
[reference]
kind = "sines"
center_rad = [0.0]
fade_in_s = 0.5
[[reference.sine]]
amplitude_rad = [0.2]
frequency_hz = [0.5]
phase_rad = [0.0]
"#;
    let path = folder.join("positions.toml");
    fs::write(&path, text).unwrap();
    assert_eq!(same(&path, On::Sim), 0);
    // With what is known of it fed forward, by itself and under a supervisor that has samples to miss.
    let known = format!("{text}[feedforward]\nmodel = \"inverse_dynamics\"\nmass_scale = 0.8\n");
    fs::write(&path, &known).unwrap();
    assert_eq!(same(&path, On::Sim), 0);
    let lossy = "[world.network]\nsample_loss = 0.05\n";
    let guarded =
        known.replace("[start]\ntorque_nm = \"gravity\"\n", &format!("{SUPERVISED}{lossy}"));
    assert!(guarded != known);
    fs::write(&path, guarded).unwrap();
    assert!(same(&path, On::Sim) > 0);
}

/// The clock changes when a sample is taken, and nothing of what is in it.
#[test]
#[cfg(target_os = "linux")]
fn by_the_clock_the_trace_is_the_same() {
    let path = folder("clock").join("clock.toml");
    let lossy = "[world.network]\nsample_loss = 0.05\n[reference]";
    let text = PLAIN.replace("duration_s = 2.0", "duration_s = 0.3").replace("[reference]", lossy);
    fs::write(&path, text.replace("settle_s = 1.0", "settle_s = 0.1")).unwrap();
    assert!(same(&path, On::SimRealTime) > 0);
}

/// A link that a user of the library brings is looked at and driven as the ones that are known here.
#[test]
fn a_link_of_ones_own_is_driven_too() {
    let path = folder("own").join("own.toml");
    fs::write(&path, format!("{PLAIN}{SUPERVISED}")).unwrap();
    let out = path.with_extension("out");
    let run = RunOptions { study: path.clone(), out: Some(out.clone()), ..RunOptions::default() };
    let run = RunOptions { uncertified: true, ..run };
    let (session, _) = run.open().unwrap();
    let study = session.study().clone();
    let (_, world) = sides(&study);
    let (_, trace) = session.run(|_| ());
    let mut file = Vec::new();
    trace.write_parquet(&mut file).unwrap();
    let accept = vec![CheckName::Certificate, CheckName::Window];
    let options = DriveOptions { run, accept, ..DriveOptions::default() };
    let prepared = prepare_on(&options, Box::new(SimLink::lock_step(&study, world))).unwrap();
    assert!(!prepared.is_refused(), "{:?}", prepared.checks);
    let leave = Leave { folder: &out, page: None };
    let driven = prepared.drive(leave, &mut (), &AtomicBool::new(false)).unwrap();
    assert!(fs::read(out.join("trace.parquet")).unwrap() == file);
    assert_eq!(driven.document["on"], "over the simulated arm");
}
