//! `phihat run`: the whole way, from a study to evidence.

use std::process::ExitCode;

use clap::Args;

use crate::failure::Failure;
use crate::record::RunArguments;

/// Take a study through gains, the closed loop and a report.
///
/// Writes report.html, static figures, trace.csv, metrics.json, gains.json, run.json and copies of the study and of the
/// files it names to out/STUDY/.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  phihat run studies/panda.toml")]
pub(crate) struct Run {
    #[command(flatten)]
    arguments: RunArguments,
}

impl Run {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let (session, folder) = self.arguments.open()?;
        let page = folder.join("report.html");
        let done = session.simulate(&folder, Some(&page))?;
        Ok(done.print(self.arguments.json, &folder, Some(&page)))
    }
}
