//! A sweep as a process: killed at every stage and sharded, the same bytes; its commands repeat the worst
//! run; bad input is reported.

use std::fs;
use std::path::Path;

use crate::support::{Running, folder, json, phihat, swing};

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
fn killed_at_every_stage_and_in_shards_it_leaves_the_same_bytes() {
    let folder = folder("sweep-killed");
    fs::write(folder.join("good.toml"), swing(1.5)).unwrap();
    let whole = phihat(&folder, &[&SWEEP[..], &["--out", "whole", "--jobs", "1"]].concat());
    assert!(whole.code < 2, "{}{}", whole.out, whole.err);
    let whole_bytes = bytes(&folder, "whole");
    // Killed before it has done anything, while it writes rows and lines of the journal, and between them, a
    // process gets there.
    let killed = [&SWEEP[..], &["--out", "killed", "--jobs", "2"]].concat();
    let all = std::env::var_os("PHIHAT_ALL").is_some();
    let early = (1..=8).step_by(if all { 1 } else { 3 }).map(|number| format!("pause {number}"));
    let late = ["pause 3 journal.jsonl", "pause 4 journal.jsonl", "pause 1 report.html"];
    for strike in early.chain(late.map(str::to_owned)) {
        let mut running = Running::of(&folder, &killed, Some(&strike));
        assert!(running.is_struck() && running.kill(), "{strike}");
    }
    let journal = folder.join("killed/journal.jsonl");
    fs::remove_file(&journal).unwrap();
    let lines = || fs::read_to_string(&journal).map_or(0, |text| text.lines().count());
    for done in if all { &[1, 4, 12, 25, 39][..] } else { &[1, 39] } {
        // However late it is killed, it does not come further than to its answer.
        let mut running = Running::of(&folder, &killed, Some("pause 1 sweep.json"));
        assert!(running.until("so many runs are in the journal", || lines() >= *done));
        assert!(running.kill());
    }
    assert!(!folder.join("killed/sweep.json").exists());
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
        joint["error_steady_max_rad"].as_f64().unwrap() / joint["error_bound_rad"].as_f64().unwrap()
    });
    let over = over.fold(0.0, f64::max);
    assert_eq!(over.to_bits(), worst["error"].as_f64().unwrap().to_bits());
}
