//! `phihat report`: the page from a recorded trace, without running anything.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use phihat_paper::{Reproduction, reproduction_page};
use phihat_session::disk::folder_of;
use phihat_session::{
    LOST_MAX_S, Recovered, files, how_to_recover, is_unfinished, recover, report_again, trace_at,
};
use serde_json::json;

use crate::failure::Failure;
use crate::terminal::PageOptions;

/// Make the report of a recorded trace again.
///
/// Reads run.json, study.toml, gains.json and metrics.json beside the trace, as `phihat run` leaves them.
/// Files that are not of one run are refused. In the folder of a reproduction it reads reproduction.json.
/// With --recover, a drive whose process was killed gets its record first.
#[derive(Debug, Args)]
#[command(after_help = "Example (after `phihat run studies/first.toml`):\n  \
                        phihat report out/first")]
pub(crate) struct ReportVerb {
    /// The trace of an earlier run (Parquet or CSV), or its folder; or the folder of a reproduction.
    trace: PathBuf,
    /// The page to write [default: report.html beside the trace].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Make a record of what is left of a drive that was killed, in place of the older record in the folder.
    #[arg(long)]
    recover: bool,
    /// Print one JSON document in place of a line.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    shown: PageOptions,
}

impl ReportVerb {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        if let Some(page) = self.reproduced()? {
            if self.json {
                println!("{}", json!({ "report": page }));
            } else {
                println!("report: {}", page.display());
            }
            self.shown.show(&page);
            return Ok(ExitCode::SUCCESS);
        }
        let recovered = self.recover.then(|| recover(self.folder())).transpose()?;
        let trace = trace_at(&self.trace);
        let page = self.out.clone().unwrap_or_else(|| trace.with_file_name("report.html"));
        let kept = report_again(&trace, &page)?;
        if is_unfinished(self.folder()) {
            let how = how_to_recover(self.folder());
            eprintln!(
                "note: a later drive into this folder was killed; {how}, in place of this one"
            );
        }
        if self.json {
            let mut told = json!({ "report": page, "metrics": kept.seen.metrics });
            if let Some(Recovered { samples, until_s }) = recovered {
                told["recovered"] = json!({ "samples": samples, "until_s": until_s });
            }
            println!("{told}");
        } else {
            if let Some(Recovered { samples, until_s }) = recovered {
                println!(
                    "recovered: {samples} samples, up to t = {until_s:.3} s; what was driven in the last \
                        {LOST_MAX_S:.0} s at most is lost"
                );
            }
            println!("report: {}", page.display());
        }
        self.shown.show(&page);
        Ok(ExitCode::SUCCESS)
    }

    /// Writes the page of a reproduction again, in a folder that has no trace but its statements; `None`: there are
    /// none.
    fn reproduced(&self) -> Result<Option<PathBuf>, Failure> {
        let data = self.trace.join("reproduction.json");
        if !data.is_file() || trace_at(&self.trace).exists() {
            return Ok(None);
        }
        let text = files::read(&data)?;
        let whole: Reproduction =
            serde_json::from_str(&text).map_err(|why| Failure::at(&data, why))?;
        let page = self.out.clone().unwrap_or_else(|| self.trace.join("report.html"));
        files::write(&page, &reproduction_page(&whole))?;
        Ok(Some(page))
    }

    /// The folder of the record.
    fn folder(&self) -> &Path {
        if self.trace.is_dir() { &self.trace } else { folder_of(&self.trace) }
    }
}
