//! `phihat report`: the page from a recorded trace, without running anything.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use phihat_session::{report_again, trace_at};
use serde_json::json;

use crate::failure::Failure;
use crate::terminal::Page;

/// Make the report of a recorded trace again.
///
/// Reads run.json, study.toml, gains.json and metrics.json beside the trace, as `phihat run` leaves them. Files that are
/// not of one run are refused.
#[derive(Debug, Args)]
#[command(after_help = "Example (after `phihat run studies/first.toml`):\n  \
                        phihat report out/first")]
pub(crate) struct Report {
    /// The trace of an earlier run (Parquet or CSV), or its folder.
    trace: PathBuf,
    /// The page to write [default: report.html beside the trace].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of a line.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    shown: Page,
}

impl Report {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let trace = trace_at(&self.trace);
        let page = self.out.clone().unwrap_or_else(|| trace.with_file_name("report.html"));
        let kept = report_again(&trace, &page)?;
        if self.json {
            println!("{}", json!({ "report": page, "metrics": kept.seen.metrics }));
        } else {
            println!("report: {}", page.display());
        }
        self.shown.show(&page);
        Ok(ExitCode::SUCCESS)
    }
}
