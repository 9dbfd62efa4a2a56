//! `phihat verify`: every claim about a set of gains, checked again.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use phihat_design::Gains;
use serde_json::json;

use crate::failure::Failure;
use crate::{files, table};

/// Check every claim of a certificate again, from the gains alone.
///
/// Needs nothing but the file: no study, no robot, no solver's word.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 1: a claim does not hold; the inequality that fails is told.\n\n\
                        Example (after `phihat design studies/panda_design.toml`):\n  \
                        phihat verify out/panda_design/gains.json"
)]
pub(crate) struct Verify {
    /// The gains document (JSON).
    gains: PathBuf,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
}

impl Verify {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let text = files::read(&self.gains)?;
        let gains = Gains::from_json(&text).map_err(|e| Failure::at(&self.gains, e))?;
        let Some(certificate) = &gains.certificate else {
            return Err(Failure::at(&self.gains, "these gains carry no certificate"));
        };
        let refuted = certificate.verify(&gains).err();
        if self.json {
            println!("{:#}", json!({ "holds": refuted.is_none(), "refuted": refuted }));
        } else if let Some(why) = &refuted {
            println!("REFUSED: {why}");
        } else {
            println!("{}", table::certificate(certificate));
            println!("every claim holds");
        }
        Ok(if refuted.is_none() { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }
}
