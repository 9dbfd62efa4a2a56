//! `phihat simulate`: the closed loop, trace and metrics only.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;

use crate::failure::Failure;
use crate::record::Session;

/// Run a study's closed loop: trace and metrics, no report.
///
/// Writes trace.csv, metrics.json, gains.json, run.json and a copy of the study to out/STUDY/.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  phihat simulate studies/first.toml --json")]
pub(crate) struct Simulate {
    /// The study file (TOML).
    study: PathBuf,
    /// Use these gains (a gains.json) in place of those the study states.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// Folder for the results [default: out/STUDY].
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Run gains even where the arm's inertia is not inside their window; marked in the record.
    #[arg(long)]
    uncertified: bool,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
}

impl Simulate {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let session = Session::open(
            &self.study,
            self.gains.as_deref(),
            self.out.as_deref(),
            self.uncertified,
        )?;
        let done = session.simulate()?;
        Ok(done.print(self.json, None))
    }
}
