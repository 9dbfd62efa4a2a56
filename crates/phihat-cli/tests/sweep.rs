//! A sweep as a process: killed at random and sharded, the same bytes; its commands repeat the worst run; bad input is told.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::support::{folder, json, phihat, swing};

const SWEEP: [&str; 10] = [
    "sweep",
    "good.toml",
    "--vary",
    "world.payload.mass_kg=0..6",
    "--vary",
    "world.coulomb_extra_nm=log:0.1..10",
    "--runs",
    "40",
    "--seed",
    "3",
];

fn bytes(folder: &Path, out: &str) -> Vec<Vec<u8>> {
    let all = ["sweep.json", "runs.npy", "report.html"];
    all.map(|name| fs::read(folder.join(out).join(name)).unwrap()).to_vec()
}

#[test]
fn killed_at_random_and_in_shards_it_leaves_the_same_bytes() {
    let folder = folder("sweep-killed");
    fs::write(folder.join("good.toml"), swing(1.5)).unwrap();
    let whole = phihat(&folder, &[&SWEEP[..], &["--out", "whole", "--jobs", "1"]].concat());
    assert!(whole.code < 2, "{}{}", whole.out, whole.err);
    let whole_bytes = bytes(&folder, "whole");
    // A process that is killed again and again, later each time, gets there.
    for k in 0..60_u64 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_phihat"))
            .args([&SWEEP[..], &["--out", "killed", "--jobs", "2"]].concat())
            .current_dir(&folder)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        sleep(Duration::from_millis(20 + 37 * k));
        child.kill().unwrap();
        child.wait().unwrap();
        if folder.join("killed/sweep.json").exists() {
            break;
        }
    }
    let resumed = phihat(&folder, &[&SWEEP[..], &["--out", "killed"]].concat());
    assert_eq!(resumed.code, whole.code, "{}", resumed.err);
    assert!(bytes(&folder, "killed") == whole_bytes);
    for shard in ["1/3", "3/3"] {
        let words = ["--out", "parts", "--shard", shard];
        assert_eq!(phihat(&folder, &[&SWEEP[..], &words].concat()).code, 0);
    }
    let missing = phihat(&folder, &["merge", "parts"]);
    assert!(missing.code == 2 && missing.err.contains("shards 2 of 3"), "{}", missing.err);
    assert_eq!(
        phihat(&folder, &[&SWEEP[..], &["--out", "parts", "--shard", "2/3"]].concat()).code,
        0
    );
    assert_eq!(phihat(&folder, &["merge", "parts"]).code, whole.code);
    assert!(bytes(&folder, "parts") == whole_bytes);
}

#[test]
fn the_command_of_the_worst_run_repeats_it() {
    let folder = folder("sweep-worst");
    fs::write(folder.join("good.toml"), swing(1.5)).unwrap();
    let told = json(&folder, &[&SWEEP[..], &["--out", "out", "--json"]].concat());
    let worst = told["sweep"]["worst"].as_array().unwrap().iter();
    let worst = worst.clone().find(|run| run["ended"] == "whole").unwrap();
    let command = worst["command"].as_str().unwrap();
    let words: Vec<&str> = command.split_whitespace().skip(1).collect();
    let out = folder.join("out");
    let run = phihat(&out, &[&words[..], &["--out", "again"]].concat());
    assert!(run.code < 2, "{}", run.err);
    let text = fs::read_to_string(out.join("again/metrics.json")).unwrap();
    let metrics: serde_json::Value = serde_json::from_str(&text).unwrap();
    let joints = metrics["joints"].as_array().unwrap().iter();
    let over = joints.map(|joint| {
        joint["error_steady_max_rad"].as_f64().unwrap() / joint["error_spec_rad"].as_f64().unwrap()
    });
    let over = over.fold(0.0, f64::max);
    assert_eq!(over.to_bits(), worst["error"].as_f64().unwrap().to_bits());
}
