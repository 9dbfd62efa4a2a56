//! `phihat report`: the page from a recorded trace, without running anything.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use phihat_design::Gains;
use phihat_report::{Record, RunInfo};
use phihat_sim::{Metrics, Trace};
use phihat_study::Study;

use crate::failure::Failure;
use crate::files;
use crate::record::settle;

/// Make the report of a recorded trace again.
///
/// Reads study.toml, gains.json and run.json beside the trace, as `phihat run` leaves them.
#[derive(Debug, Args)]
#[command(after_help = "Example (after `phihat run studies/first.toml`):\n  \
                        phihat report out/first/trace.csv")]
pub(crate) struct Report {
    /// The trace (CSV) of an earlier run.
    trace: PathBuf,
    /// The page to write [default: report.html beside the trace].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of a line.
    #[arg(long)]
    json: bool,
}

impl Report {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let folder = self.trace.parent().unwrap_or(Path::new(""));
        let beside = |name: &str| folder.join(name);
        let file = files::open(&self.trace)?;
        let trace = Trace::read_csv(file).map_err(|e| Failure::at(&self.trace, e))?;
        let run_path = beside("run.json");
        let run: RunInfo = serde_json::from_str(&files::read(&run_path)?)
            .map_err(|e| Failure::at(&run_path, e))?;
        let gains_path = beside("gains.json");
        let gains = Gains::from_json(&files::read(&gains_path)?)
            .map_err(|e| Failure::at(&gains_path, e))?;
        let mut study = Study::read(&beside("study.toml")).map_err(|e| Failure::study(&e))?;
        settle(&mut study, &gains);
        let metrics = Metrics::of(&trace, &study);
        let record = Record {
            run: &run,
            study_text: &study.text,
            gains: &gains,
            trace: &trace,
            metrics: &metrics,
        };
        let page = self.out.clone().unwrap_or_else(|| beside("report.html"));
        let page = write_report(&record, &page)?;
        if self.json {
            println!("{}", serde_json::json!({ "report": page, "metrics": metrics }));
        } else {
            println!("report: {}", page.display());
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// Writes the page, and its figures into `figures/` beside it.
///
/// # Errors
///
/// [`Failure`], naming the file that cannot be written.
pub fn write_report(record: &Record<'_>, page: &Path) -> Result<PathBuf, Failure> {
    let folder = page.parent().unwrap_or(Path::new("")).join("figures");
    files::make_folder(&folder)?;
    for figure in phihat_report::figures(record) {
        files::write(&folder.join(format!("{}.svg", figure.name)), &figure.svg)?;
    }
    files::write(page, &phihat_report::page(record))?;
    Ok(page.to_owned())
}
