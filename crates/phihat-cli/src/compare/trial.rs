//! One run of a comparison again, with everything it leaves.

use core::fmt;
use std::path::{Path, PathBuf};

use phihat_campaign::compare::{Comparison, Plan};
use phihat_campaign::disk::Whole;
use phihat_report::{Drawing, Trial, trial_page};
use phihat_sim::{Metrics, Outcome};
use serde_json::json;

use super::unusable;
use crate::failure::Failure;

/// What a run left.
pub(super) struct Kept {
    folder: PathBuf,
    ended: Option<String>,
    metrics: Metrics,
}

/// What a run leaves, in the order in which it is written.
pub(super) fn results(folder: &Path, name: &str) -> [PathBuf; 4] {
    let folder = folder.join("runs").join(name);
    ["study.toml", "metrics.json", "trace.csv", "report.html"].map(|name| folder.join(name))
}

/// Runs it, and writes study, trace, metrics and report to `FOLDER/runs/NAME/`.
pub(super) fn keep(
    plan: &Plan,
    comparison: &Comparison,
    name: &str,
    folder: &Path,
    command: &str,
) -> Result<Kept, Failure> {
    let (study, outcome) = plan.repeat(comparison, name).map_err(|e| unusable(&e))?;
    let metrics = Metrics::of(&outcome.trace, &study);
    let results = results(folder, name);
    let folder = folder.join("runs").join(name);
    let ended = ended(&outcome);
    let page = trial_page(&Trial {
        name,
        law: comparison.rivals.first().map_or("", |rival| &rival.title),
        gains: &gains(comparison, name),
        ended: ended.as_deref(),
        study: &study.text,
        drawing: &Drawing::of(&outcome.trace, metrics.settle_s),
        metrics: &metrics,
        command,
    });
    let figures = format!("{:#}\n", json!(metrics));
    let mut whole = Whole::in_locked_folder();
    // Nothing says of these files which run they are of: no older one may stand beside a new one.
    for path in &results {
        whole.remove(path.clone());
    }
    let [text, data, trace, html] = &results;
    let added = whole
        .add(text, study.text.as_bytes())
        .and_then(|_| whole.add(data, figures.as_bytes()))
        .and_then(|_| whole.add_with(trace, |file| outcome.trace.write_csv(file)))
        .and_then(|_| whole.add(html, page.as_bytes()));
    added.and_then(|_| whole.commit()).map_err(Failure::plain)?;
    Ok(Kept { folder, ended, metrics })
}

/// The scalars that the run had: name, value, unit.
fn gains(comparison: &Comparison, name: &str) -> Vec<(String, f64, String)> {
    let (Some(rival), Some(row)) = (comparison.rivals.first(), comparison.rows.first()) else {
        return Vec::new();
    };
    let Some(tuning) = &row.tuning else { return Vec::new() };
    let tuned = name.split('/').nth(3) == Some("tuned");
    let values = if tuned { &tuning.tuned } else { &tuning.default };
    let with = |(scalar, value): (&phihat_campaign::compare::ScalarRecord, &f64)| {
        (scalar.name.clone(), *value, scalar.unit.clone())
    };
    rival.scalars.iter().zip(values).map(with).collect()
}

/// Why the run ended before its time.
fn ended(outcome: &Outcome) -> Option<String> {
    let diverged = outcome.divergence.as_ref().map(|d| {
        format!("The arm diverged at {} s, joint {}, and the run was stopped.", d.t, d.joint)
    });
    let stopped = outcome.abort.as_ref();
    diverged.or_else(|| stopped.map(|a| format!("The robot stopped at {} s: {}.", a.t, a.reason)))
}

impl Kept {
    /// For programs.
    pub(super) fn document(&self) -> serde_json::Value {
        json!({
            "folder": self.folder,
            "report": self.folder.join("report.html"),
            "ended": self.ended,
            "metrics": self.metrics,
        })
    }
}

impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(why) = &self.ended {
            writeln!(f, "{why}")?;
        }
        writeln!(f, "trace: {}", self.folder.join("trace.csv").display())?;
        write!(f, "report: {}", self.folder.join("report.html").display())
    }
}
