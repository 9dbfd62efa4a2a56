//! `cargo xtask fuzz`: documents and samples that the tests did not draw, for as long as one likes.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Documents per target and round.
const CASES: u32 = 20_000;

/// Rounds of every target with other seeds until the minutes are over, optimised; what breaks one is kept in
/// `crates/phihat-fuzz/corpus`.
pub(crate) fn run(root: &Path, minutes: Option<&String>) -> Result<(), String> {
    let minutes = match minutes.map(|text| text.parse::<f64>()) {
        None => 10.0,
        Some(Ok(minutes)) if minutes > 0.0 && minutes < 1e5 => minutes,
        Some(_) => return Err("MINUTES is a number above 0".to_owned()),
    };
    let end = Instant::now() + Duration::from_secs_f64(minutes * 60.0);
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_err(|e| e.to_string())?;
    // Fits the 32 bits of a seed for the next hundred years.
    let first = now.as_secs() % u64::from(u32::MAX);
    for (round, seed) in (first..).enumerate() {
        if Instant::now() >= end {
            println!("{round} rounds of {CASES} documents per target: nothing broke");
            break;
        }
        let output = Command::new("cargo")
            .args(["test", "--quiet", "--release", "-p", "phihat-fuzz", "-p", "phihat-c"])
            .args(["--test", "tests", "--no-fail-fast", "--", "fuzz::"])
            .env("PHIHAT_FUZZ_SEED", seed.to_string())
            .env("PHIHAT_FUZZ_CASES", CASES.to_string())
            .current_dir(root)
            .output()
            .map_err(|e| format!("cargo cannot be started: {e}"))?;
        if !output.status.success() {
            for text in [output.stdout, output.stderr] {
                eprint!("{}", String::from_utf8_lossy(&text));
            }
            return Err(format!(
                "something broke with seed {seed}: the bytes are in crates/phihat-fuzz/corpus, tried first from now on"
            ));
        }
        println!("round {round}, seed {seed}: nothing broke");
    }
    Ok(())
}
