//! `phihat audit`: the assumptions of a certificate, held against a record.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use phihat_session::{Audit, AuditRow, Standing, audit};
use serde_json::json;

use crate::failure::Failure;

/// Exit code where a record breaks an assumption.
pub(crate) const BROKEN: u8 = 4;

/// Hold what a certificate assumes against the record of a drive or a run.
///
/// Bound on the error, φ, rotor inertia, delay, jitter, lost samples, encoder, noise, dry friction, payload,
/// torque, limits and reference: each is held, broken or not told by this record, per joint, with the figure
/// in the record, the figure assumed, and the time at which it broke. Rotors, friction and payload are
/// intervals: broken is one that has no value in common with the assumed one. Of what is broken, the lines of
/// a study are printed for which the record conforms.
///
/// Takes the study and the gains of the record, or others. A record in which nothing is broken proves nothing
/// about the next one.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 everything is held or not told · 4 something is broken · 2 error.\n\n\
                        Example (after `phihat run studies/first.toml`):\n  \
                        phihat audit out/first"
)]
pub(crate) struct AuditVerb {
    /// The folder of the record.
    record: PathBuf,
    /// Hold it against these gains (a gains.json) in place of its own.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// Hold it against this study in place of its own.
    #[arg(long, value_name = "STUDY")]
    study: Option<PathBuf>,
    /// Print one JSON document in place of the lines.
    #[arg(long)]
    json: bool,
}

impl AuditVerb {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let found = audit(&self.record, self.gains.as_deref(), self.study.as_deref())?;
        if self.json {
            let broken = found.broken().count();
            println!("{:#}", json!({ "broken": broken, "rows": found.rows }));
        } else {
            println!("{}", lines(&found, true));
        }
        Ok(code(&found))
    }
}

/// Exit code of an audit.
pub(crate) fn code(found: &Audit) -> ExitCode {
    if found.broken().next().is_some() { ExitCode::from(BROKEN) } else { ExitCode::SUCCESS }
}

/// An audit of a record that was left in a folder, in lines: without what is held where nothing else is asked for.
pub(crate) fn lines(found: &Audit, all: bool) -> String {
    let shown = |row: &&AuditRow| all || row.standing == Standing::Broken;
    let mut lines: Vec<String> = found.rows.iter().filter(shown).map(line).collect();
    let changes = found.broken().filter_map(|row| row.change.as_deref());
    let mut changes: Vec<&str> = changes.collect();
    changes.dedup();
    if !changes.is_empty() {
        lines.push(format!("the record conforms to a study with\n{}", changes.join("\n")));
    }
    let count = |standing| found.rows.iter().filter(|row| row.standing == standing).count();
    let broken = count(Standing::Broken);
    let words = if broken > 0 { "BROKEN" } else { "HELD" };
    lines.push(format!(
        "{words}: of {} assumptions {broken} are broken by this record, {} are not told",
        found.rows.len(),
        count(Standing::NotTold)
    ));
    lines.join("\n")
}

fn line(row: &AuditRow) -> String {
    let standing = match row.standing {
        Standing::Held => "held",
        Standing::Broken => "BROKEN",
        Standing::NotTold => "not told",
    };
    let joint = row.joint.as_ref().map_or_else(String::new, |joint| format!(", {joint}"));
    let figure = |(low, high): (f64, f64)| {
        if (high - low).abs() > 0.0 { format!("{low:.4} … {high:.4}") } else { short(low) }
    };
    let figures = row.recorded.zip(row.assumed).map(|(recorded, assumed)| {
        format!(": {} in the record, {} {} assumed", figure(recorded), figure(assumed), row.unit)
    });
    let time = row.time_s.map_or_else(String::new, |t| format!(", from {t:.3} s on"));
    let why = row.why.map_or_else(String::new, |why| format!(": {why}"));
    let (words, figures) = (row.assumption.words(), figures.unwrap_or_default());
    format!("{standing:<8} {words}{joint}{figures}{time}{why}")
}

/// A figure of four digits.
fn short(value: f64) -> String {
    let size = value.abs();
    if size > 0.0 && !(1e-3..1e5).contains(&size) {
        format!("{value:.3e}")
    } else {
        format!("{value:.4}")
    }
}

/// Lines about the record in a folder, after a drive; `None`: there is no audit of it.
pub(crate) fn after(folder: &Path) -> Option<Audit> {
    audit(folder, None, None).ok()
}
