//! One run of a comparison again, with everything it leaves.

use std::path::{Path, PathBuf};

use phihat_report::Drawing;
use phihat_session::TraceKind;
use phihat_session::disk::Whole;
use phihat_sim::{Metrics, SimulationOutcome};
use serde_json::json;

use crate::error::CompareError;
use crate::page::{PageTrial, trial_page};
use crate::plan::ComparisonPlan;
use crate::record::Comparison;

/// A run that was repeated, with everything that it left.
#[derive(Debug)]
pub struct Repeated {
    /// Folder of its files.
    pub folder: PathBuf,
    /// Its trace.
    pub trace: PathBuf,
    /// Why it ended before its time.
    pub ended: Option<String>,
    /// Its figures.
    pub metrics: Metrics,
}

/// Files of a run's results, in the order in which they are written.
pub(crate) fn results(folder: &Path, name: &str, kind: TraceKind) -> [PathBuf; 4] {
    let folder = folder.join("runs").join(name);
    ["study.toml", "metrics.json", kind.file(), "report.html"].map(|name| folder.join(name))
}

/// Runs it, and writes study, trace, metrics and report to `FOLDER/runs/NAME/`.
pub(crate) fn keep(
    plan: &ComparisonPlan,
    comparison: &Comparison,
    (name, kind): (&str, TraceKind),
    folder: &Path,
    command: &str,
) -> Result<Repeated, CompareError> {
    let (study, outcome) = plan.repeat(comparison, name)?;
    let metrics = Metrics::of(&outcome.trace, &study);
    let results = results(folder, name, kind);
    let folder = folder.join("runs").join(name);
    let ended = ended(&outcome);
    let page = trial_page(&PageTrial {
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
    let traces = TraceKind::ALL.map(|kind| folder.join(kind.file()));
    for path in results.iter().chain(traces.iter().filter(|trace| !results.contains(trace))) {
        whole.remove(path.clone());
    }
    let [text, data, trace, html] = &results;
    let added = whole
        .add(text, study.text.as_bytes())
        .and_then(|_| whole.add(data, figures.as_bytes()))
        .and_then(|_| match kind {
            TraceKind::Parquet => whole.add_with(trace, |file| outcome.trace.write_parquet(file)),
            TraceKind::Csv => whole.add_with(trace, |file| outcome.trace.write_csv(file)),
        })
        .and_then(|_| whole.add(html, page.as_bytes()));
    added.and_then(|_| whole.commit())?;
    let trace = trace.clone();
    Ok(Repeated { folder, trace, ended, metrics })
}

/// The scalars that the run had: name, value, unit.
fn gains(comparison: &Comparison, name: &str) -> Vec<(String, f64, String)> {
    let (Some(rival), Some(row)) = (comparison.rivals.first(), comparison.rows.first()) else {
        return Vec::new();
    };
    let Some(tuning) = &row.tuning else { return Vec::new() };
    let tuned = name.split('/').nth(3) == Some("tuned");
    let values = if tuned { &tuning.tuned } else { &tuning.default };
    let with = |(scalar, value): (&crate::record::ScalarRecord, &f64)| {
        (scalar.name.clone(), *value, scalar.unit.clone())
    };
    rival.scalars.iter().zip(values).map(with).collect()
}

/// Why the run ended before its time.
fn ended(outcome: &SimulationOutcome) -> Option<String> {
    let diverged = outcome.divergence.as_ref().map(|d| {
        format!("The arm diverged at {} s, joint {}, and the run was stopped.", d.t, d.joint)
    });
    let stopped = outcome.abort.as_ref();
    diverged.or_else(|| stopped.map(|a| format!("The robot stopped at {} s: {}.", a.t, a.reason)))
}
