//! `phihat simulate`: the closed loop, trace and metrics only.

use std::process::ExitCode;

use clap::Args;

use crate::failure::Failure;
use crate::record::RunArguments;

/// Run a study's closed loop: trace and metrics, no report.
///
/// Writes trace.csv, metrics.json, gains.json, run.json and copies of the study and of the files it names to out/STUDY/.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  phihat simulate studies/first.toml --json")]
pub(crate) struct Simulate {
    #[command(flatten)]
    arguments: RunArguments,
}

impl Simulate {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let (session, folder) = self.arguments.open()?;
        let done = session.simulate(&folder, None)?;
        Ok(done.print(self.arguments.json, &folder, None))
    }
}
