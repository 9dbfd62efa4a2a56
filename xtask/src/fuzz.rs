//! `cargo xtask fuzz`: documents and samples that the tests did not draw, for as long as one likes.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// Targets of `phihat-fuzz` and `phihat-c`, some side by side.
const TARGETS: f64 = 10.0;

/// Runs every target for its share of some minutes, optimised, with a seed of its own; what breaks one is kept in
/// `crates/phihat-fuzz/corpus`.
pub(crate) fn run(root: &Path, minutes: Option<&String>) -> Result<(), String> {
    let minutes = match minutes.map(|text| text.parse::<f64>()) {
        None => 10.0,
        Some(Ok(minutes)) if minutes > 0.0 && minutes < 1e5 => minutes,
        Some(_) => return Err("MINUTES is a number above 0".to_owned()),
    };
    let side_by_side = std::thread::available_parallelism().map_or(1.0, |n| n.get() as f64);
    let each = minutes * 60e3 * side_by_side.min(TARGETS) / TARGETS;
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_err(|e| e.to_string())?;
    let seed = now.as_nanos().to_string();
    println!("{minutes} minutes, seed {seed}");
    let status = Command::new("cargo")
        .args(["test", "--release", "-p", "phihat-fuzz", "-p", "phihat-c", "--test", "fuzz"])
        .args(["--no-fail-fast", "--", "--nocapture"])
        .env("BOLERO_RANDOM_SEED", seed)
        .env("BOLERO_RANDOM_TEST_TIME_MS", format!("{each:.0}"))
        .env("BOLERO_RANDOM_ITERATIONS", u64::MAX.to_string())
        .current_dir(root)
        .status()
        .map_err(|e| format!("cargo cannot be started: {e}"))?;
    if status.success() {
        return Ok(());
    }
    Err("something broke: the bytes are in crates/phihat-fuzz/corpus, tried first from now on"
        .into())
}
