//! `phihat run` and `phihat simulate`: from a study to evidence.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::UNIX_EPOCH;

use clap::Args;
use phihat_certificate::Verdict;
use phihat_report::{RecordedBound, limits_acted, scope_of_bound, stop_in_words};
use phihat_session::{
    Done, RunOptions, SessionError, TraceKind, contact_lines, files, log_layout, short_hash,
    stopped, trace_at,
};
use serde_json::json;

use crate::failure::Failure;
use crate::shown::{TerminalWatch, second_derivation, spinner};
use crate::table;
use crate::terminal::{PageOptions, is_quiet};

/// What `run` and `simulate` are told.
#[derive(Debug, Args)]
struct RunArguments {
    /// The study file (TOML).
    study: PathBuf,
    #[command(flatten)]
    which: Which,
    /// Folder for the results [default: out/STUDY].
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    #[command(flatten)]
    trace: TraceOptions,
    /// Write a log for ROS tools and viewers too (MCAP; builds with the feature `mcap`).
    #[arg(long, value_name = "FILE")]
    mcap: Option<PathBuf>,
    /// Write how Foxglove or Lichtblick shows that log.
    #[arg(long, value_name = "FILE", requires = "mcap")]
    layout: Option<PathBuf>,
    /// Say too what proofs say of what is refused.
    #[arg(long)]
    verbose: bool,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
}

/// Which gains run.
#[derive(Debug, Args)]
struct Which {
    /// Use these gains (a gains.json) in place of those the study states.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// Design the gains anew, even where the folder holds those that this program designed for the same study.
    #[arg(long, conflicts_with = "gains")]
    fresh: bool,
    /// Run gains even where the arm's inertia is not inside their window; marked in the record.
    #[arg(long)]
    uncertified: bool,
}

/// Which kind of file has the trace.
#[derive(Debug, Args)]
pub(crate) struct TraceOptions {
    /// Write the trace as a text, trace.csv, in place of trace.parquet: several times larger, and slower.
    #[arg(long)]
    csv: bool,
}

impl TraceOptions {
    pub(crate) fn kind(&self) -> TraceKind {
        TraceKind::csv(self.csv)
    }
}

/// Take a study through gains, the closed loop and a report.
///
/// Writes report.html, static figures, trace.parquet, metrics.json, gains.json, run.json and copies of the
/// study and of the files it names to out/STUDY/. Gains that were designed for it there are not designed once
/// more while study, files and program are the same.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  phihat run studies/panda.toml")]
pub(crate) struct RunVerb {
    #[command(flatten)]
    arguments: RunArguments,
    /// Derive the bound on the error a second time before the run, as `phihat verify` does with the study, and say
    /// in record and report what came of it: DERIVED TWICE or NOT PROVED. Takes seconds to minutes.
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    page: PageOptions,
}

/// Run a study's closed loop: trace and metrics, no report.
///
/// Writes trace.parquet, metrics.json, gains.json, run.json and copies of the study and of the files it names
/// to out/STUDY/.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  phihat simulate studies/first.toml --json")]
pub(crate) struct Simulate {
    #[command(flatten)]
    arguments: RunArguments,
}

impl RunVerb {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        self.arguments.execute(Some(&self.page), self.verify)
    }
}

impl Simulate {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        self.arguments.execute(None, false)
    }
}

const BAR: &str = "simulating {wide_bar} {percent:>3} % · {elapsed} of about {duration}";
const UNTOUCHED: &str = "nothing was written, and what was there is as it was";

impl RunArguments {
    fn execute(&self, shown_page: Option<&PageOptions>, twice: bool) -> Result<ExitCode, Failure> {
        let options = RunOptions {
            study: self.study.clone(),
            gains: self.which.gains.clone(),
            out: self.out.clone(),
            uncertified: self.which.uncertified,
            program: build(),
            fresh: self.which.fresh,
            trace: self.trace.kind(),
            log: self.mcap.clone(),
        };
        let (mut session, folder) = match options.open() {
            Ok(opened) => opened,
            Err(why) => return self.refused(&options, why),
        };
        if twice {
            let bar = spinner();
            session.derive_twice(&|share| {
                bar.set_message(second_derivation(share));
                bar.tick();
            })?;
            bar.finish_and_clear();
        }
        if session.designed_before() && !is_quiet() {
            let file = folder.join("gains.json");
            eprintln!(
                "gains: designed by the last run of this study, {} (--fresh designs them anew)",
                file.display()
            );
        }
        let page = shown_page.map(|_| folder.join("report.html"));
        // A document is one piece, and told when all of it is true.
        let says: Option<fn(&Done)> = if self.json { None } else { Some(figures) };
        let mut shown = TerminalWatch::bar(BAR, UNTOUCHED.to_owned()).saying(says);
        let done = session.simulate(&folder, page.as_deref(), &mut shown)?;
        write_layout(self.layout.as_deref(), &done)?;
        if self.json {
            println!("{:#}", document(&done, &folder, page.as_deref()));
        } else {
            left(&folder, page.as_deref());
        }
        if let (Some(shown), Some(page)) = (shown_page, &page) {
            shown.show(page);
        }
        Ok(if done.good() { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }
}

/// Identity of this build: the version, and size and modification time of the executable file.
fn build() -> Option<String> {
    let file = std::env::current_exe().ok()?.metadata().ok()?;
    let written = file.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    let version = env!("CARGO_PKG_VERSION");
    let this = short_hash(&[&file.len().to_string(), &written.as_nanos().to_string()]);
    Some(format!("phihat {version}, build {this}"))
}

impl RunArguments {
    /// Why nothing runs: where no gains keep what is asked for, with what the error is spent on and what would help.
    fn refused(&self, options: &RunOptions, why: SessionError) -> Result<ExitCode, Failure> {
        if self.verbose
            && let Some(words) = why.in_full()
        {
            eprintln!("{words}");
        }
        if let SessionError::Infeasible { no, .. } = &why {
            let mut shown = TerminalWatch::bar("{spinner} {msg} · {elapsed}", String::new());
            let (budget, files) = options.explain(no, &mut shown)?;
            if !self.json {
                println!("{}", table::budget(&budget));
            }
            eprintln!("budget: {}", files.page.display());
        }
        Err(why.into())
    }
}

/// Writes how a viewer shows the log, where that was asked for.
pub(crate) fn write_layout(layout: Option<&Path>, done: &Done) -> Result<(), Failure> {
    let Some(path) = layout else { return Ok(()) };
    Ok(files::write(path, &format!("{:#}\n", log_layout(&done.study)))?)
}

/// Result of a run, as one document.
pub(crate) fn document(done: &Done, folder: &Path, report: Option<&Path>) -> serde_json::Value {
    let diverged = done.divergence.as_ref().map(|d| json!({ "t_s": d.t, "joint": d.joint }));
    let stopped_at = done.abort.as_ref().map(
        |a| json!({ "t_s": a.t, "interface": a.interface, "joint": a.joint, "reason": a.reason.to_string() }),
    );
    json!({
        "study": done.study.name,
        "folder": folder,
        "report": report,
        "diverged": diverged,
        "stopped": stopped_at,
        "verdict": done.verdict(),
        "limited": limits_acted(&done.metrics),
        "metrics": done.figures(),
    })
}

/// Result of a run, as tables.
pub(crate) fn show(done: &Done, folder: &Path, report: Option<&Path>) {
    figures(done);
    left(folder, report);
}

fn figures(done: &Done) {
    println!("{} · {}", done.study.name, done.study.title);
    if let Some(stopped) = stop_in_words(&done.metrics, &done.run) {
        println!("{stopped}");
    }
    println!("{}", table::metrics(&done.metrics, done.run.knows_phi()));
    if let Some(tip) = table::tip(&done.metrics) {
        println!("{tip}");
    }
    if let Some(run) = &done.tube {
        println!("{}", table::tube(run, &done.metrics));
    }
    if let Some(bound) = &done.run.bound {
        println!("{}", checked(bound, done));
    }
    if let Some(record) = &done.run.contact {
        for line in contact_lines(record) {
            println!("{line}");
        }
    }
    match &done.abort {
        Some(abort) => println!("{}", stopped(abort)),
        None => println!("{}", table::verdict(&done.metrics, done.divergence.as_ref())),
    }
}

/// A bound that was derived a second time, in a line that begins with its standing.
fn checked(bound: &RecordedBound, done: &Done) -> String {
    let joints = done.metrics.joints.iter().zip(&bound.error_bound_rad);
    let largest = joints.max_by(|a, b| a.1.total_cmp(b.1));
    let (word, words) = (bound.verdict.words(), &bound.words);
    match largest {
        Some((joint, most)) if bound.verdict > Verdict::NotProved => {
            let unit = if joint.slides { "mm" } else { "mrad" };
            // A bound is rounded up.
            let most = (1e6 * most).ceil() / 1e3;
            let which = scope_of_bound(done.gains.as_ref(), &done.metrics, &done.run);
            format!(
                "{word}: |e| ≤ {most:.3} {unit} on every joint{which} (largest on {})",
                joint.name
            )
        }
        _ => format!("{word}: {words}"),
    }
}

/// Prints the path of a run's page, or of its trace.
fn left(folder: &Path, report: Option<&Path>) {
    match report {
        Some(page) => println!("report: {}", page.display()),
        None => println!("trace: {}", trace_at(folder).display()),
    }
}
