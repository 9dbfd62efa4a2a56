//! Instructions of one sample, counted by callgrind: the same on every run, unlike time.

use std::path::Path;
use std::process::Command;

/// Bounds for 7 joints, second order: what it is, and its most.
const LAW_MAX: f64 = 900.0;
/// The law from positions: at most half as much more.
const SEEN_MAX: f64 = 1.5 * LAW_MAX;
/// The same with a filter of two sections on its innovation: at most 0.4 times as much more.
const FILTERED_MAX: f64 = 1.4 * SEEN_MAX;
/// Guard, limits and modes around it.
const PLAIN_MAX: f64 = 3500.0;
/// With joint ranges and monitors.
const ARM_MAX: f64 = 4500.0;
/// Largest over smallest count of a supervised sample, over inputs without a fault.
const SPREAD_MAX: f64 = 1.3;

/// Counts every class and holds it against its bound.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    crate::tools::from_debian(root, "valgrind", &["valgrind"])?;
    let program = build(root, "phihat")?;
    let mut wrong = Vec::new();
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for (class, bound) in [
        ("law", LAW_MAX),
        ("seen", SEEN_MAX),
        ("filtered", FILTERED_MAX),
        ("plain", PLAIN_MAX),
        ("rest", ARM_MAX),
        ("motion", ARM_MAX),
        ("jitter", ARM_MAX),
        ("limits", ARM_MAX),
        ("range", ARM_MAX),
        ("shaped", f64::INFINITY),
    ] {
        // What the set-up costs is in both.
        let (few, many) = (300, 1300);
        let each =
            (count(&program, class, many)? - count(&program, class, few)?) / f64::from(many - few);
        println!("{class}: {each:.0} instructions per sample of 7 joints, m = 2");
        if each > bound {
            wrong.push(format!("{class}: {each:.0} instructions, at most {bound}"));
        }
        if !["law", "seen", "filtered", "plain", "shaped"].contains(&class) {
            (least, most) = (least.min(each), most.max(each));
        }
    }
    println!("spread of a supervised sample: {:.2}", most / least);
    if most > SPREAD_MAX * least {
        wrong.push(format!("spread {:.2}, at most {SPREAD_MAX}", most / least));
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// Counts the cycles of a drive's control thread: supervisor, law, motion and record, and what its link costs.
pub(crate) fn drive(root: &Path) -> Result<(), String> {
    let program = build(root, "phihat-drive")?;
    for (class, what) in [
        ("loop", "over a link that costs nothing"),
        ("fci5", "over the Franka Control Interface, version 5"),
        ("fci10", "over the Franka Control Interface, version 10"),
    ] {
        let (few, many) = (300, 1300);
        let each =
            (count(&program, class, many)? - count(&program, class, few)?) / f64::from(many - few);
        println!("{class}: {each:.0} instructions per cycle of 7 joints, {what}");
    }
    println!("(without those of the system's kernel)");
    Ok(())
}

/// The bench for any processor: callgrind does not know the newest instructions.
pub(crate) fn build(root: &Path, package: &str) -> Result<String, String> {
    let output = Command::new("cargo")
        .args(["bench", "-p", package, "--bench", "instructions", "--no-run"])
        .args(["--message-format", "json"])
        .env("RUSTFLAGS", "")
        .env("CARGO_TARGET_DIR", root.join("target/instructions"))
        .current_dir(root)
        .output()
        .map_err(|e| e.to_string())?;
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .find_map(|message| message["executable"].as_str().map(str::to_owned))
        .ok_or_else(|| String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Instructions of a whole run.
fn count(program: &str, class: &str, samples: u32) -> Result<f64, String> {
    collected(program, &[class, &samples.to_string()])
}

/// Instructions of a program with these arguments.
pub(crate) fn collected(program: &str, arguments: &[&str]) -> Result<f64, String> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", program])
        .args(arguments)
        .output()
        .map_err(|e| format!("valgrind cannot be started: {e}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let collected = text.lines().find_map(|line| line.split("Collected :").nth(1));
    collected
        .and_then(|count| count.trim().parse().ok())
        .ok_or_else(|| format!("callgrind counted nothing:\n{text}"))
}
