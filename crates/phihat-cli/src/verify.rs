//! `phihat verify`: every claim about a set of gains, checked again.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use phihat_design::{Gains, Statement, Verified};
use phihat_study::Study;
use serde_json::json;

use crate::failure::Failure;
use crate::{files, table};

/// Check every claim of a certificate again, from the gains alone.
///
/// Needs nothing but the file: no solver's word. What the file cannot show of itself is listed as taken on trust; with a
/// study, that is derived again as far as it can be.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 1: a claim does not hold; the inequality that fails is told.\n\n\
                        Example (after `phihat design studies/panda_design.toml`):\n  \
                        phihat verify out/panda_design/gains.json"
)]
pub(crate) struct Verify {
    /// The gains document (JSON).
    gains: PathBuf,
    /// Derive again from this study what the file alone has to be trusted for.
    #[arg(long, value_name = "STUDY")]
    study: Option<PathBuf>,
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
        let read = |path: &PathBuf| Study::read(path).map_err(|e| Failure::study(&e));
        let study = self.study.as_ref().map(read).transpose()?;
        let answer = certificate.verified(&gains).and_then(|mut verified| {
            if let Some(study) = &study {
                verified.derived = certificate.derive(&gains, study)?;
            }
            Ok(verified)
        });
        if self.json {
            let holds = answer.is_ok();
            let document = match &answer {
                Ok(verified) => json!({ "holds": holds, "refuted": null, "verified": verified }),
                Err(why) => json!({ "holds": holds, "refuted": why }),
            };
            println!("{document:#}");
        } else {
            match &answer {
                Ok(verified) => println!("{}", blocks(verified)),
                Err(why) => println!("REFUSED: {why}"),
            }
        }
        Ok(if answer.is_ok() { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }
}

/// The three blocks, and what a study says of the second.
fn blocks(verified: &Verified) -> String {
    let line = |one: &Statement| {
        let joint = one.joint.as_ref().map_or_else(String::new, |joint| format!("{joint}: "));
        format!("  {joint}{}: {}", one.what, one.value)
    };
    let block = |title: &str, lines: Vec<String>| {
        let lines = if lines.is_empty() { vec!["  nothing".to_owned()] } else { lines };
        format!("{title}\n{}", lines.join("\n"))
    };
    let mut blocks = vec![
        block("PROVED FROM THIS FILE", verified.proved.iter().map(line).collect()),
        block("TAKEN ON TRUST", verified.trusted.iter().map(line).collect()),
    ];
    if !verified.derived.is_empty() {
        blocks
            .push(block("OF THAT, AGAINST THE STUDY", verified.derived.iter().map(line).collect()));
    }
    let left = table::not_counted(&verified.not_counted);
    let left = left.into_iter().map(|one| format!("  {one}")).collect();
    blocks.push(block("NOT COUNTED", left));
    blocks.push("every claim holds".to_owned());
    blocks.join("\n")
}
