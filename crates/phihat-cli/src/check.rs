//! `phihat check`: all that is wrong with a study, at once, without running it.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use phihat_model::input::plain;
use phihat_session::{StudyCheck, check, check_rewritten};
use phihat_study::{RenamedKey, Study};
use serde_json::json;

/// Tell all that is wrong with studies, and what would be valid, without running them.
///
/// Reads the study, the files that it names (arm, reference, trace) and its gains. One line per error: file,
/// line, key, value, and what would be valid. Gains that are left to the design are not designed.
#[derive(Debug, Args)]
#[command(after_help = "Exit code 2: there are errors.\n\nExample:\n  \
                        phihat check studies/first.toml studies/panda.toml\n  phihat check --rewrite \
                        studies/first.toml")]
pub(crate) struct CheckVerb {
    /// The study files (TOML).
    #[arg(required = true)]
    studies: Vec<PathBuf>,
    /// Look at these gains (a gains.json) in place of those the studies state.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// First give keys of earlier versions their names of now, in the files themselves; comments and order stay.
    ///
    /// Gains that were designed for such a study name the sum of its text: design them again.
    #[arg(long)]
    rewrite: bool,
    /// Print one JSON document in place of lines.
    #[arg(long)]
    json: bool,
}

impl CheckVerb {
    pub(crate) fn execute(&self) -> ExitCode {
        let gains = self.gains.as_deref();
        let looked = |path: &PathBuf| {
            let (renamed, found) = if self.rewrite {
                check_rewritten(path, gains)
            } else {
                (Vec::new(), check(path, gains))
            };
            (path.clone(), renamed, found)
        };
        let all: Vec<_> = self.studies.iter().map(looked).collect();
        let valid = all.iter().all(|(.., found)| found.errors.is_empty());
        let code = if valid { 0 } else { 2 };
        if self.json {
            let studies: Vec<_> = all.iter().map(document).collect();
            println!("{:#}", json!({ "valid": valid, "exit_code": code, "studies": studies }));
        } else {
            all.iter().for_each(tell);
        }
        ExitCode::from(code)
    }
}

/// Warns of keys that studies have under the names of earlier versions; of a study that cannot be read, others tell.
pub(crate) fn warn_of_renamed<'a>(studies: impl IntoIterator<Item = &'a PathBuf>) {
    for study in studies.into_iter().filter_map(|path| Study::read(path).ok()) {
        study.renamed.iter().for_each(|key| eprintln!("warning: {}", plain(&key.to_string())));
    }
}

/// A study's file, the keys that were renamed in it, and what was found.
type CheckedFile = (PathBuf, Vec<RenamedKey>, StudyCheck);

fn document((path, renamed, found): &CheckedFile) -> serde_json::Value {
    let renamed: Vec<_> = renamed
        .iter()
        .map(|key| json!({ "line": key.line(), "before": key.before(), "now": key.now() }))
        .collect();
    json!({
        "study": path,
        "valid": found.errors.is_empty(),
        "errors": found.errors,
        "warnings": found.warnings,
        "renamed": renamed,
    })
}

fn tell((path, renamed, found): &CheckedFile) {
    let file = path.display().to_string();
    for key in renamed {
        println!("{file}:{}: {} renamed to {}", key.line(), key.before(), key.now());
    }
    for error in &found.errors {
        eprintln!("error: {}", plain(&error.to_string()));
    }
    for warning in &found.warnings {
        // That of a renamed key names the file and its line itself.
        let named = found.study.iter().flat_map(|study| &study.renamed);
        let whole = named.map(ToString::to_string).any(|line| line == *warning);
        let place = if whole { String::new() } else { format!("{file}: ") };
        eprintln!("warning: {}", plain(&format!("{place}{warning}")));
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
