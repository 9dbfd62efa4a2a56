//! Runs the real binary in a folder of its own.
#![allow(dead_code, reason = "each test file uses its part")]

mod running;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

pub(crate) use running::{Running, wait_for};

/// Files below a folder, by their paths from there.
pub(crate) type Files = BTreeMap<PathBuf, Vec<u8>>;

/// Exit code and output of a run of the binary.
pub(crate) struct Answer {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

/// A fresh folder that sees the project's studies as `studies/`.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME")).join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    std::fs::create_dir_all(folder.join("studies")).unwrap();
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    for entry in std::fs::read_dir(studies).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, folder.join("studies").join(path.file_name().unwrap())).unwrap();
        }
    }
    folder
}

/// Runs `phihat` in a folder.
pub(crate) fn phihat(folder: &Path, arguments: &[&str]) -> Answer {
    answer(Command::new(env!("CARGO_BIN_EXE_phihat")).args(arguments).current_dir(folder))
}

/// Runs a command.
pub(crate) fn answer(command: &mut Command) -> Answer {
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Answer {
        code: output.status.code().unwrap_or(-1),
        out: text(output.stdout),
        err: text(output.stderr),
    }
}

/// The same, and the JSON it printed.
pub(crate) fn json(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let answer = phihat(folder, arguments);
    serde_json::from_str(&answer.out)
        .unwrap_or_else(|e| panic!("{e}\n{}\n{}", answer.out, answer.err))
}

/// Runs it, and presses Ctrl-C once it listens and a file has something in it.
pub(crate) fn interrupted(folder: &Path, arguments: &[&str], once: &str) -> Answer {
    interrupted_in(Running::of(folder, arguments, None), &folder.join(once))
}

/// Presses Ctrl-C once a process listens and a file has something in it.
pub(crate) fn interrupted_in(mut running: Running, once: &Path) -> Answer {
    let written = || std::fs::metadata(once).is_ok_and(|file| file.len() > 0);
    let caught = |status: String| {
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
        // SIGINT is the second signal.
        u64::from_str_radix(mask.trim(), 16).unwrap() & 2 != 0
    };
    let id = running.child.id().to_string();
    let status = format!("/proc/{id}/status");
    // Where there is no such file, what is written tells.
    let listens =
        || !Path::new("/proc").exists() || std::fs::read_to_string(&status).is_ok_and(caught);
    let what = format!("it listens to Ctrl-C, and something is in {}", once.display());
    assert!(running.until(&what, || listens() && written()), "it ended before: {what}");
    let sent = Command::new("kill").args(["-INT", &id]).status().unwrap();
    assert!(sent.success());
    running.answer()
}

/// Every file below a folder.
pub(crate) fn files_of(folder: &Path) -> Files {
    let mut found = Files::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for entry in std::fs::read_dir(&at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let bytes = std::fs::read(&path).unwrap();
                found.insert(path.strip_prefix(folder).unwrap().to_owned(), bytes);
            }
        }
    }
    found
}

/// Makes these the files below a folder.
pub(crate) fn leave(folder: &Path, files: &Files) {
    std::fs::remove_dir_all(folder).unwrap();
    for (name, bytes) in files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
}

/// A study of one joint that runs in no time.
pub(crate) fn small(title: &str, amplitude_rad: f64, bandwidth_rad_s: f64) -> String {
    format!(
        "title = \"{title}\"\nduration_s = 0.05\n[robot]\nname = \"planar3r\"\n\
         locked = {{ joint2 = 0.0, joint3 = 0.0 }}\n[spec]\nsettle_s = 0.01\nerror_bound_rad = 0.2\n[gains]\norder = \
         2\nbandwidth_rad_s = {bandwidth_rad_s:?}\nestimator_bandwidth_rad_s = 40.0\ninertia_kg_m2 = 0.8\n[reference]\n\
         kind = \"sines\"\ncenter_rad = 0.1\n[[reference.sine]]\namplitude_rad = {amplitude_rad:?}\nfrequency_hz = \
         0.4\nphase_rad = 0.0\n"
    )
}

/// A study of one joint that swings, its gains left to the design; half a second is enough to settle.
pub(crate) fn swing(duration_s: f64) -> String {
    format!(
        r#"duration_s = {duration_s:?}
[robot]
name = "planar3r"
locked = {{ joint2 = 0.5, joint3 = 0.5 }}
[spec]
error_bound_rad = 4e-3
[design]
settling_time_s = 0.2
[loop]
form = "observer"
torque_rate_max_nm_s = "none"
[sensor]
encoder_bits = 18
[reference]
kind = "sines"
center_rad = [0.0]
fade_in_s = 0.5
[[reference.sine]]
amplitude_rad = [0.2]
frequency_hz = [0.5]
phase_rad = [0.0]
"#
    )
}
