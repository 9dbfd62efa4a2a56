//! A drive over the Franka Control Interface, against a study's world behind it. Wrong if a computed torque
//! differed from that of the simulation, or from the one that acted; if a robot that stopped went on, or its
//! reason were lost; or if anything moved that a check refuses.

use std::fs;
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::support::served::patient;
use crate::support::{PANDA, folder};
use phihat_drive::{CheckName, DriveError, DriveOptions, Driven, End, On, State, prepare};
use phihat_fci::{Ending, Event, Pace, Protocol};
use phihat_session::{Leave, RunOptions, ServeOptions, ServeWatch, ServedMotion, TraceKind};
use phihat_sim::Trace;

/// A Panda whose torque is reported as demanded: the law gets the same data in the simulation as over the network.
fn panda() -> String {
    let rest = r#"
[spec]
settle_s = 0.3
error_bound_rad = 0.5
[supervisor]
error_stop_rad = 0.5
[reference]
kind = "sines"
center = "ready"
fade_in_s = 0.2
[[reference.sine]]
amplitude_rad = 0.05
frequency_hz = 0.5
phase_rad = 0.0
"#;
    let told = PANDA.replace("[sensor]", "[sensor]\ntorque = \"demanded\"");
    format!("title = \"A Panda over the wire\"\nduration_s = 0.6\nseed = 3\n{told}{rest}")
}

/// Ends of the motions of a served study.
#[derive(Default)]
struct Seen(Vec<Ending>);

impl ServeWatch for Seen {
    fn event(&mut self, _: Event) {}
    fn motion(&mut self, motion: &ServedMotion) {
        self.0.push(motion.ending);
    }
}

/// A study that is served until so many cycles are over; where, and how its motions ended.
fn serve(study: &Path, cycles: u64) -> (String, JoinHandle<Vec<Ending>>) {
    let options = ServeOptions {
        study: study.to_owned(),
        out: Some(study.with_extension("served")),
        listen: Ipv4Addr::LOCALHOST.into(),
        port: 0,
        trace: TraceKind::default(),
        pace: Pace::LockStep { patience: Duration::from_mins(1) },
        cycles: Some(cycles),
    };
    let mut served = options.open().unwrap();
    let address = served.address().to_string();
    let serving = thread::spawn(move || {
        let mut seen = Seen::default();
        served.run(&mut seen).unwrap();
        seen.0
    });
    (address, serving)
}

fn written(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path
}

fn options(study: &Path, link: &str) -> DriveOptions {
    let run = RunOptions {
        study: study.to_owned(),
        out: Some(study.with_extension("driven")),
        uncertified: true,
        ..RunOptions::default()
    };
    let accept = vec![CheckName::Certificate, CheckName::RealTime, CheckName::Rehearsal];
    DriveOptions { run, on: patient(link), accept, ..DriveOptions::default() }
}

fn driven(options: &DriveOptions) -> Driven {
    let out = options.run.out.clone().unwrap();
    let leave = Leave { folder: &out, page: None };
    let prepared = prepare(options).unwrap();
    assert!(!prepared.is_refused(), "{:#?}", prepared.checks);
    prepared.drive(leave, &mut (), &AtomicBool::new(false)).unwrap()
}

fn simulated(study: &Path) -> Trace {
    let options =
        RunOptions { study: study.to_owned(), uncertified: true, ..RunOptions::default() };
    options.open().unwrap().0.run(|_| ()).1
}

/// The record that a study left in a folder beside it.
fn record(study: &Path, folder: &str) -> Trace {
    let file = fs::File::open(study.with_extension(folder).join("trace.parquet")).unwrap();
    Trace::read(file, &phihat_session::read(study).unwrap()).unwrap()
}

/// Fails where the law has the robot's velocity in place of the one that its gains are certified for: this robot
/// filters its velocity by another low-pass, and the drive has to be the simulation of its own study all the same.
#[test]
fn the_law_has_the_studys_velocity_whatever_the_robot_says() {
    let folder = folder("franka-velocity");
    let other = panda().replace("velocity_filter_hz = 45.0", "velocity_filter_hz = 400.0");
    let (study, other) =
        (written(&folder, "own.toml", &panda()), written(&folder, "other.toml", &other));
    let (address, serving) = serve(&other, 600);
    let driven = driven(&options(&study, &format!("fci://{address}?protocol=5")));
    assert_eq!((driven.tally.end, driven.tally.lost), (End::Complete, 0));
    serving.join().unwrap();
    for (own, whole) in record(&study, "driven").joints.iter().zip(&simulated(&study).joints) {
        assert!(own.dq_measured == whole.dq_measured, "{}", own.name);
        assert!(own.tau_command == whole.tau_command, "{}", own.name);
    }
}

#[test]
fn what_is_driven_over_the_wire_is_what_is_simulated() {
    let folder = folder("franka-same");
    for protocol in Protocol::ALL {
        let version = protocol.version();
        let study = written(&folder, &format!("v{version}.toml"), &panda());
        let (address, serving) = serve(&study, 600);
        let options = options(&study, &format!("fci://{address}?protocol={version}"));
        let driven = driven(&options);
        assert_eq!(
            (driven.tally.end, driven.tally.cycles, driven.tally.lost),
            (End::Complete, 600, 0)
        );
        assert_eq!(driven.tally.finished, Ok(()));
        assert_eq!(serving.join().unwrap(), [Ending::Over]);
        let own = record(&study, "driven");
        let (world, whole) = (record(&study, "served"), simulated(&study));
        assert_eq!((own.len(), world.len()), (600, 600));
        for ((own, world), whole) in own.joints.iter().zip(&world.joints).zip(&whole.joints) {
            // Torques go over the wire in double precision in both versions.
            assert!(own.tau_command == world.tau_command, "{}: another torque acted", own.name);
            if protocol == Protocol::V5 {
                assert!(own.q_measured == whole.q_measured, "{}", own.name);
                assert!(own.tau_command == whole.tau_command, "{}", own.name);
            } else {
                // In single precision the encoder may come to show the step beside.
                let both = own.q_measured.iter().zip(&whole.q_measured);
                let most = both.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(most < 5e-5, "{}: {most}", own.name);
            }
        }
        let check = |name| {
            driven.document["checks"]
                .as_array()
                .unwrap()
                .iter()
                .any(|check| check["name"] == name && check["state"] == "passed")
        };
        assert!(check("robot") && (check("description") == (protocol == Protocol::V10)));
    }
}

/// Every state that the world loses is a lost sample, in its place.
#[test]
fn states_that_do_not_come_are_lost_samples() {
    let folder = folder("franka-lossy");
    let lossy =
        panda().replace("[supervisor]", "[world.network]\nsample_loss = 0.05\n[supervisor]");
    let study = written(&folder, "lossy.toml", &lossy);
    let (address, serving) = serve(&study, 600);
    let driven = driven(&options(&study, &format!("fci://{address}?protocol=5")));
    serving.join().unwrap();
    let own = record(&study, "driven");
    assert_eq!((driven.tally.end, own.len() as u64), (End::Complete, driven.tally.cycles));
    // The last states may be lost at the end, where no other tells of them.
    assert!((595..=600).contains(&driven.tally.cycles), "{:?}", driven.tally);
    let whole = simulated(&study);
    // From 0.2 to 0.45 s the arm is faster than a step of the encoder per sample: a position twice is a lost sample.
    let stale = |trace: &Trace| {
        let q = &trace.joints[0].q_measured;
        (200..450).filter(|&k| q[k].to_bits() == q[k - 1].to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(stale(&own), stale(&whole));
    assert!((15..=45).contains(&driven.tally.lost), "{:?}", driven.tally);
}

/// Losses (F4, F20 of docs/reliability.md) and a load that falls, F12, over the network: every cycle driven,
/// no torque step, no reflex.
#[test]
fn losses_jitter_and_a_dropped_load_are_borne() {
    let folder = folder("franka-hard");
    let hard = panda()
        .replace("duration_s = 0.6", "duration_s = 2.0")
        .replace("encoder_bits = 18", "encoder_bits = 18\nsample_jitter_s = 2e-4")
        .replace(
            "[supervisor]",
            "[world.network]\ncommand_loss = 0.1\nsample_loss = 0.1\n[supervisor]",
        )
        .replace(
            "mass_kg = 0.5, com_m = [0.0, 0.0, 0.05]",
            "mass_kg = 1.0, com_m = [0.0, 0.0, 0.08], end_s = 1.0",
        )
        .replace(
            "[1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]",
            "[1.88, 2.34, 1.08, 1.35, 0.261, 0.273, 0.224]",
        );
    let study = written(&folder, "hard.toml", &hard);
    for protocol in Protocol::ALL {
        let (address, serving) = serve(&study, 2000);
        let mut told = options(&study, &format!("fci://{address}?protocol={}", protocol.version()));
        // Jitter is in no window's model.
        told.accept.push(CheckName::Window);
        let driven = driven(&told);
        assert_eq!(serving.join().unwrap(), [Ending::Over]);
        assert_eq!((driven.tally.end, driven.document["fault"].is_null()), (End::Complete, true));
        assert!((150..250).contains(&driven.tally.lost), "{:?}", driven.tally);
        let world = record(&study, "served");
        let largest = |values: &[f64]| values.iter().map(|e| e.abs()).fold(0.0, f64::max);
        for joint in &world.joints {
            let steps = joint.tau_command.windows(2).map(|pair| (pair[1] - pair[0]).abs());
            assert!(steps.fold(0.0, f64::max) <= 1.0 + 1e-9, "{}: the torque jumps", joint.name);
            let (before, last) = (largest(&joint.e[500..1000]), largest(&joint.e[1700..]));
            let during = largest(&joint.e[1000..1700]);
            println!(
                "{} v{}: {before:.1e} {during:.1e} {last:.1e} rad",
                joint.name,
                protocol.version()
            );
            assert!(
                before < 0.02 && during < 0.05 && last < 0.02,
                "{}: {before} {during} {last}",
                joint.name
            );
        }
    }
}

#[test]
fn a_robot_that_stops_ends_the_drive_and_is_brought_back() {
    let folder = folder("franka-reflex");
    // The controller keeps no rule of a robot that has one.
    let reckless = panda()
        .replace(
            "[profile]\nname = \"robot\"",
            "[profile]\nname = \"robot\"\ncontroller_keeps = false",
        )
        .replace("bandwidth_rad_s = 20.0", "bandwidth_rad_s = 60.0")
        .replace("amplitude_rad = 0.05", "amplitude_rad = 0.4");
    let study = written(&folder, "reckless.toml", &reckless);
    for protocol in Protocol::ALL {
        let (address, serving) = serve(&study, 600);
        let mut told = options(&study, &format!("fci://{address}?protocol={}", protocol.version()));
        let refused = prepare(&told).unwrap();
        let profile = refused.checks.iter().find(|check| check.name == CheckName::Profile).unwrap();
        assert!(
            profile.state == State::Failed && profile.found.contains("controller_keeps"),
            "{profile:?}"
        );
        let leave = Leave { folder: &folder, page: None };
        let why = refused.drive(leave, &mut (), &AtomicBool::new(false)).unwrap_err();
        assert!(matches!(why, DriveError::Refused(_)));
        told.accept = CheckName::ALL.to_vec();
        told.recover = true;
        let stopped = driven(&told);
        assert!(!stopped.good());
        assert_eq!(stopped.document["fault"], "the robot stopped: controller_torque_discontinuity");
        assert_eq!(stopped.document["recovered"], true);
        let run = fs::read_to_string(study.with_extension("driven").join("run.json")).unwrap();
        assert!(run.contains("STOPPED by the robot"), "{run}");
        drop(serving);
    }
}

#[test]
fn what_is_not_there_or_another_arm_is_refused() {
    let folder = folder("franka-refused");
    let study = written(&folder, "study.toml", &panda());
    let nobody = prepare(&options(&study, "fci://127.0.0.1:1")).unwrap_err().to_string();
    assert!(nobody.contains("fci://127.0.0.1:1") && nobody.contains("refused"), "{nobody}");
    for wrong in ["fci://", "fci://robot?protocol=7", "ur://robot", "SIM"] {
        assert!(On::of(wrong, false).unwrap_err().to_string().contains("is valid"), "{wrong}");
    }
    assert!(On::of("fci://robot", true).is_err());
    let link = On::of("fci://robot:99?protocol=5", false).unwrap();
    assert_eq!(link.words(), "--on fci://robot:99?protocol=5");
    // The arm stands where the served study begins, and the motion begins elsewhere.
    let (address, serving) = serve(&study, 600);
    let elsewhere =
        panda().replace("center = \"ready\"", "center_rad = [0.0, 0.0, 0.0, -1.5, 0.0, 1.5, 0.0]");
    let elsewhere = written(&folder, "elsewhere.toml", &elsewhere);
    let found = prepare(&options(&elsewhere, &format!("fci://{address}"))).unwrap();
    let robot = found.checks.iter().find(|check| check.name == CheckName::Robot).unwrap();
    assert!(found.is_refused() && robot.state == State::Failed, "{robot:?}");
    assert!(robot.found.contains("panda_joint2 stands at -0.785 rad"), "{}", robot.found);
    drop((found, serving));
}
