//! `phihat serve --fci`, with this project's client on the other side of the wire. Wrong if the served world
//! were another than the simulated one in a single bit, if a record were not that of the motion, or if a
//! study that no Franka serves were taken.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;

use crate::support::{folder, phihat};
use phihat_fci::{Client, Protocol, Reflex, RobotMode};
use serde_json::Value;

/// A Panda with bare drives, encoders, friction and a payload; every tenth command is lost.
const STUDY: &str = r#"
title = "A served Panda"
duration_s = 0.4
seed = 3
[robot]
name = "panda"
[profile]
name = "ideal"
[spec]
settle_s = 0.3
error_bound_rad = 0.5
[gains]
order = 2
bandwidth_rad_s = 20.0
estimator_bandwidth_rad_s = 50.0
inertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]
[loop]
rate_hz = 1000.0
delay_samples = 1
torque_max_nm = "none"
torque_rate_max_nm_s = "none"
[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 45.0
[world]
friction = "robot"
payload = { frame = "panda_link8", mass_kg = 0.5, com_m = [0.0, 0.0, 0.05] }
[world.network]
command_loss = 0.1
[reference]
kind = "sines"
center = "ready"
[[reference.sine]]
amplitude_rad = 0.1
frequency_hz = 0.5
phase_rad = 0.0
"#;

/// `phihat serve`, and the lines that it prints.
struct Served {
    child: Child,
    lines: BufReader<ChildStdout>,
    address: String,
}

impl Served {
    fn study(folder: &Path, arguments: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_phihat"))
            .args(["serve", "study.toml", "--fci", "--port", "0", "--json"])
            .args(arguments)
            .current_dir(folder)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap());
        let mut new = Self { child, lines, address: String::new() };
        let first = new.line();
        assert_eq!(first["loopback"], true);
        first["listening"].as_str().unwrap().clone_into(&mut new.address);
        new
    }

    /// A client that waits a minute for a state: libfranka's 1 s would fail a test whose server does not get
    /// a processor for that long.
    fn client(&self, protocol: Protocol) -> Client {
        Client::connect_patient(&self.address, protocol, Duration::from_mins(1)).unwrap()
    }

    fn line(&mut self) -> Value {
        let mut line = String::new();
        self.lines.read_line(&mut line).unwrap();
        serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line:?}"))
    }

    /// The next line that tells of a motion.
    fn motion(&mut self) -> Value {
        loop {
            let line = self.line();
            if line.get("motion").is_some() {
                return line;
            }
        }
    }

    fn code(mut self) -> i32 {
        self.child.wait().unwrap().code().unwrap()
    }
}

/// Columns of a trace, one row per sample, seven values each.
fn columns(trace: &Path, names: &[&str]) -> Vec<Vec<[f64; 7]>> {
    let text = fs::read_to_string(trace).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let column = |name: &&str| {
        let at = header.iter().position(|column| column == name).unwrap();
        let sample = |rows: &[Vec<&str>]| core::array::from_fn(|i| rows[i][at].parse().unwrap());
        rows.chunks(7).map(sample).collect()
    };
    names.iter().map(column).collect()
}

fn bits(values: &[[f64; 7]]) -> Vec<[u64; 7]> {
    values.iter().map(|values| values.map(f64::to_bits)).collect()
}

/// Plays torques, the last with the finish flag; what the states said.
fn play(client: &mut Client, torques: &[[f64; 7]]) -> Vec<[f64; 7]> {
    client.start_torque().unwrap();
    let mut seen = Vec::new();
    for (k, tau) in torques.iter().enumerate() {
        let state = client.receive().unwrap();
        assert_eq!(state.mode, RobotMode::Move, "{k}: {}", state.reflex_reason);
        seen.push(state.q);
        if k + 1 < torques.len() {
            client.send_torque(state.id, tau).unwrap();
        } else {
            client.finish(state.id, tau).unwrap();
        }
    }
    seen
}

#[test]
fn the_served_world_is_the_simulated_one_to_the_last_bit() {
    let folder = folder("served");
    fs::write(folder.join("study.toml"), STUDY).unwrap();
    let simulated = phihat(&folder, &["simulate", "study.toml", "--csv", "--out", "simulated"]);
    assert_eq!(simulated.code, 0, "{}{}", simulated.out, simulated.err);
    let names = ["q_rad", "dq_rad_s", "tau_applied_nm", "q_measured_rad", "q_desired_rad", "e_rad"];
    let simulated = columns(&folder.join("simulated/trace.csv"), &names);
    let torques = &columns(&folder.join("simulated/trace.csv"), &["tau_command_nm"])[0];
    assert_eq!(torques.len(), 400);
    for (protocol, out) in Protocol::ALL.into_iter().zip(["v5", "v10"]) {
        let arguments = ["--csv", "--out", out, "--patience-ms", "60000", "--cycles", "400"];
        let mut served = Served::study(&folder, &arguments);
        let mut client = served.client(protocol);
        let seen = play(&mut client, torques);
        if protocol == Protocol::V5 {
            assert_eq!(bits(&seen), bits(&simulated[3]));
        } else {
            // In single precision.
            let apart = seen.iter().flatten().zip(simulated[3].iter().flatten());
            assert!(apart.clone().all(|(a, b)| (a - b).abs() < 2e-7));
            assert!(apart.clone().any(|(a, b)| a.to_bits() != b.to_bits()));
        }
        let motion = served.motion();
        assert_eq!(motion["motion"], "finished by the client");
        assert_eq!((&motion["cycles"], &motion["verdict"]), (&400.into(), &"within_spec".into()));
        let lost = motion["packets"]["lost"].as_u64().unwrap();
        assert!((20..=70).contains(&lost), "{lost}");
        assert_eq!(served.code(), 0);
        let found = columns(&folder.join(out).join("trace.csv"), &names);
        for ((name, found), simulated) in names.iter().zip(&found).zip(&simulated) {
            assert_eq!(bits(found), bits(simulated), "{name}");
        }
        let run: Value =
            serde_json::from_str(&fs::read_to_string(folder.join(out).join("run.json")).unwrap())
                .unwrap();
        assert_eq!((&run["form"], &run["seed"]), (&"outside".into(), &3.into()));
        assert_eq!(phihat(&folder, &["report", out]).code, 0);
    }
}

#[test]
fn a_reflex_by_the_profile_leaves_its_record_and_recovery_leads_on() {
    let folder = folder("reflex");
    let franka =
        STUDY.replace("\"ideal\"", "\"robot\"").replace("command_loss = 0.1", "command_loss = 0.0");
    fs::write(folder.join("study.toml"), franka).unwrap();
    for protocol in Protocol::ALL {
        let mut served = Served::study(&folder, &["--patience-ms", "60000", "--cycles", "130"]);
        let mut client = served.client(protocol);
        assert_eq!(
            Client::connect(&served.address, protocol).unwrap_err().to_string(),
            "the robot refused Connect (status 2)"
        );
        client.start_torque().unwrap();
        for k in 0..30 {
            let state = client.receive().unwrap();
            client.send_torque(state.id, &[if k == 29 { 1.01 } else { 0.0 }; 7]).unwrap();
        }
        let state = client.receive().unwrap();
        assert!(state.mode == RobotMode::Reflex && state.errors.has(Reflex::TorqueJump));
        // The robot holds its own weight, and shows it.
        assert!(state.tau_j[3].abs() > 5.0 && state.tau_j_d[3].to_bits() == 0.0_f64.to_bits());
        let motion = served.motion();
        assert_eq!(motion["motion"], "reflex: controller_torque_discontinuity");
        assert_eq!((&motion["cycles"], &motion["verdict"]), (&29.into(), &"stopped".into()));
        let run = fs::read_to_string(folder.join("out/study/run.json")).unwrap();
        assert!(
            run.contains(
                "STOPPED by the robot (franka) at t = 0.029 s: controller_torque_discontinuity"
            ),
            "{run}"
        );
        client.recover().unwrap();
        // To the end of what was asked for: 101 more.
        client.start_torque().unwrap();
        for _ in 0..101 {
            let state = client.receive().unwrap();
            client.send_torque(state.id, &[0.0; 7]).unwrap();
        }
        let motion = served.motion();
        assert_eq!(
            (&motion["motion"], &motion["cycles"]),
            (&"the end of the study".into(), &101.into())
        );
        // A record that is shorter than its study is not within spec.
        assert_eq!((&motion["verdict"], served.code()), (&"outside_spec".into(), 1));
    }
}

#[test]
fn a_study_that_no_franka_serves_is_one_error() {
    let folder = folder("unserved");
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("slow.toml", &STUDY.replace("rate_hz = 1000.0", "rate_hz = 500.0"));
    write("study.toml", STUDY);
    let refused = |arguments: &[&str]| {
        let answer = phihat(&folder, &[&["serve"], arguments].concat());
        assert_eq!(answer.code, 2, "{}{}", answer.out, answer.err);
        answer.err
    };
    let three = refused(&["studies/first.toml", "--fci"]);
    assert!(
        three.contains("planar3r has 3 joints; the Franka Control Interface knows arms of 7"),
        "{three}"
    );
    assert!(
        refused(&["slow.toml", "--fci"])
            .contains("loop.rate_hz = 500; the Franka Control Interface runs at 1000")
    );
    let many = refused(&["study.toml", "--fci", "--cycles", "401"]);
    assert!(many.contains("401 cycles; its motion has 400, so 1 to 400 is valid"), "{many}");
    assert!(refused(&["study.toml"]).contains("--fci"));
    assert!(
        refused(&["study.toml", "--fci", "--lockstep", "--real-time"])
            .contains("cannot be used with")
    );
    assert!(refused(&["study.toml", "--fci", "--listen", "nowhere"]).contains("nowhere"));
    assert!(
        refused(&["study.toml", "--fci", "--listen", "192.0.2.1", "--port", "0"])
            .contains("listening on 192.0.2.1:0")
    );
    assert!(!folder.join("out").exists());
}

/// The most memory that a process had so far [kB].
#[cfg(target_os = "linux")]
fn peak(child: &Child) -> u64 {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    line.trim().split(' ').next().unwrap().parse().unwrap()
}

/// Stored as a whole, 24,000 cycles more are 20 MB more.
#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_length_of_a_motion() {
    let folder = folder("served-long");
    let payload = STUDY.lines().find(|line| line.starts_with("payload")).unwrap();
    let long = STUDY.replace(payload, "").replace("\"ideal\"", "\"robot\"");
    let long = long.replace("command_loss = 0.1", "command_loss = 0.0");
    fs::write(folder.join("study.toml"), long.replace("duration_s = 0.4", "duration_s = 50.0"))
        .unwrap();
    let [short, long] = [16_000, 40_000].map(|cycles: usize| {
        let mut served = Served::study(&folder, &["--patience-ms", "60000"]);
        let mut client = served.client(Protocol::V5);
        play(&mut client, &vec![[0.0; 7]; cycles]);
        assert_eq!(served.motion()["cycles"], cycles);
        let peak = peak(&served.child);
        served.child.kill().unwrap();
        served.child.wait().unwrap();
        peak
    });
    println!("at most {short} kB in 16,000 cycles, {long} kB in 40,000");
    assert!(long < short + 8_000, "{short} kB in 16,000 cycles, {long} kB in 40,000");
}
