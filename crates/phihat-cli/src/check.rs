//! `phihat check`: all that is wrong with a study, at once, without running it.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use phihat_model::input::plain;
use phihat_session::{StudyCheck, check};
use phihat_study::Study;
use serde_json::json;

/// Tell all that is wrong with studies, and what would be valid, without running them.
///
/// Reads the study, the files that it names (arm, reference, trace) and its gains. One line per error: file,
/// line, key, value, and what would be valid. Gains that are left to the design are not designed.
#[derive(Debug, Args)]
#[command(after_help = "Exit code 2: there are errors.\n\nExample:\n  \
                        phihat check studies/first.toml studies/panda.toml")]
pub(crate) struct CheckVerb {
    /// The study files (TOML).
    #[arg(required = true)]
    studies: Vec<PathBuf>,
    /// Look at these gains (a gains.json) in place of those the studies state.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// Print one JSON document in place of lines.
    #[arg(long)]
    json: bool,
}

impl CheckVerb {
    pub(crate) fn execute(&self) -> ExitCode {
        let looked = |path: &PathBuf| (path.clone(), check(path, self.gains.as_deref()));
        let all: Vec<_> = self.studies.iter().map(looked).collect();
        let valid = all.iter().all(|(_, found)| found.errors.is_empty());
        let code = if valid { 0 } else { 2 };
        if self.json {
            let studies: Vec<_> = all.iter().map(|(path, found)| document(path, found)).collect();
            println!("{:#}", json!({ "valid": valid, "exit_code": code, "studies": studies }));
        } else {
            for (path, found) in &all {
                tell(path, found);
            }
        }
        ExitCode::from(code)
    }
}

fn document(path: &Path, found: &StudyCheck) -> serde_json::Value {
    json!({
        "study": path,
        "valid": found.errors.is_empty(),
        "errors": found.errors,
        "warnings": found.warnings,
    })
}

fn tell(path: &Path, found: &StudyCheck) {
    for error in &found.errors {
        eprintln!("error: {}", plain(&error.to_string()));
    }
    for warning in &found.warnings {
        eprintln!("warning: {}: {}", path.display(), plain(warning));
    }
    match (found.errors.len(), &found.study) {
        (0, Some(study)) => println!("valid: {} · {}", path.display(), words(study)),
        (1, _) => println!("{}: 1 error", path.display()),
        (count, _) => println!("{}: {count} errors", path.display()),
    }
}

/// Summary of a study.
fn words(study: &Study) -> String {
    let (joints, rate) = (study.robot.joints.len(), 1e9 / study.control.period_ns as f64);
    let gains = if study.gains.is_some() { "gains stated" } else { "gains left to the design" };
    format!("{}, {joints} joints, {rate} Hz, {} s, {gains}", study.robot.name, study.duration)
}
