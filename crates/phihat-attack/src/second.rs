//! A second opinion: the same study, run by a program that shares no line with ours.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::held::Violation;

/// The script that asks Pinocchio and MuJoCo.
const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/python/second_opinion.py");

/// Result of other simulators.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SecondOpinion {
    /// Runs made.
    pub runs: usize,
    /// Part of the study that they do not support.
    pub skipped: Option<String>,
    /// Largest distance from the middle of the claim, in half-widths.
    pub worst: f64,
}

#[derive(Deserialize)]
struct SecondAnswer {
    runs: Vec<SecondRun>,
    skipped: Option<String>,
}

#[derive(Deserialize)]
struct SecondRun {
    world: String,
    engine: String,
    worst: WorstOfSecond,
    left: bool,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct WorstOfSecond {
    ratio: f64,
    joint: String,
    signal: String,
    t_s: f64,
    measured: f64,
    claimed: (f64, f64),
}

/// Why there is no second opinion.
#[derive(Debug, Error)]
pub(crate) enum NoOpinion {
    /// The Python does not start.
    #[error("{}: {why}", python.display())]
    Start {
        /// The Python.
        python: PathBuf,
        /// Why.
        why: io::Error,
    },
    /// The script gave no answer.
    #[error("second opinion: {why}: {said}")]
    Answer {
        /// Parse error of its output.
        why: serde_json::Error,
        /// Its messages.
        said: String,
    },
}

/// Asks about a kept study.
///
/// # Errors
///
/// [`NoOpinion`]: the program does not start, or gives no answer.
pub(crate) fn opinion(
    python: &Path,
    folder: &Path,
) -> Result<(SecondOpinion, Vec<Violation>), NoOpinion> {
    let mut command = Command::new(python);
    command.arg(SCRIPT).arg(folder).env("OMP_NUM_THREADS", "1");
    let output =
        command.output().map_err(|why| NoOpinion::Start { python: python.to_owned(), why })?;
    let text = String::from_utf8_lossy(&output.stdout);
    let answer: SecondAnswer = serde_json::from_str(text.trim()).map_err(|why| {
        NoOpinion::Answer { why, said: String::from_utf8_lossy(&output.stderr).trim().to_owned() }
    })?;
    let worst = answer.runs.iter().map(|run| run.worst.ratio).fold(0.0, f64::max);
    let left = answer.runs.iter().filter(|run| run.left).map(|run| Violation {
        run: format!("{} in {}", run.world, run.engine),
        joint: run.worst.joint.clone(),
        signal: run.worst.signal.clone(),
        t_s: run.worst.t_s,
        measured: run.worst.measured,
        claimed: run.worst.claimed,
        ratio: run.worst.ratio,
    });
    let violations = left.collect();
    Ok((SecondOpinion { runs: answer.runs.len(), skipped: answer.skipped, worst }, violations))
}
