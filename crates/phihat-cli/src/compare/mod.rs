//! `phihat compare`: the rivals of the paper's Table 1, measured on the same arms under the same terms.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use phihat_compare::{CompareAnswer, CompareOptions, Comparison, Repeated, RunOutcome, losses};
use phihat_session::TraceKind;
use serde_json::json;

use crate::check::warn_of_renamed;
use crate::failure::Failure;
use crate::shown::TerminalWatch;
use crate::terminal::PageOptions;

mod list;
mod table;

/// Measure the rivals of the paper's Table 1 on your arms: same tuning, same worlds, same judge.
///
/// Every law is tuned by one optimiser with one budget, then runs in every world with its default and its tuned
/// gains. Writes journal.jsonl, compare.json and report.html to out/STUDY/compare/ (out/compare/ for several
/// studies). An interrupted comparison goes on where it was.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 1: the program failed in a run. A law that does not follow is an answer.\n\nExamples:\n  \
    phihat compare --list\n  \
    phihat compare --rival pd\n  \
    phihat compare studies/table1.toml --quick --only pd,computed-torque,proposed-2 --worlds exact"
)]
#[allow(clippy::struct_excessive_bools, reason = "independent switches of a command line")]
pub(crate) struct Compare {
    /// The studies (TOML), one per arm; the worlds are made from them.
    #[arg(required_unless_present_any = ["list", "rival"])]
    studies: Vec<PathBuf>,
    /// List the rivals: id, title, grade, needs, free scalars.
    #[arg(long, conflicts_with_all = ["studies", "rival"])]
    list: bool,
    /// Show a rival: law, source, grade, needs, scalars.
    #[arg(long, value_name = "ID", conflicts_with = "studies")]
    rival: Option<String>,
    /// Only these rivals.
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    only: Vec<String>,
    /// Only these worlds: exact, encoder, delay, payload, friction, saturation.
    #[arg(long, value_name = "WORLD", value_delimiter = ',')]
    worlds: Vec<String>,
    /// Few tuning runs, one motion of some seconds.
    #[arg(long)]
    quick: bool,
    /// Motions that are scored: the study's own, and drawn ones [default: 3, or 1 with --quick].
    #[arg(long, value_name = "N",
        value_parser = clap::value_parser!(u16).range(1..=1000))]
    seeds: Option<u16>,
    /// Repeat this one run (ARM/RIVAL/WORLD/default|tuned/SEED) and keep its study, trace and report.
    #[arg(long, value_name = "RUN")]
    trace: Option<String>,
    /// With --trace: as a text, trace.csv, in place of trace.parquet.
    #[arg(long, requires = "trace")]
    csv: bool,
    /// Do everything again, whatever the journal holds.
    #[arg(long)]
    fresh: bool,
    /// Runs at a time [default: one per core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Folder for the results.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of tables.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    page: PageOptions,
}

const BAR: &str = "{wide_bar} {percent} % · {msg} · {elapsed} · {eta} left";

impl Compare {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        if self.list {
            list::rivals(self.json)?;
            return Ok(ExitCode::SUCCESS);
        }
        if let Some(id) = &self.rival {
            list::rival(id, self.json)?;
            return Ok(ExitCode::SUCCESS);
        }
        warn_of_renamed(&self.studies);
        let options = CompareOptions {
            studies: self.studies.clone(),
            laws: Vec::new(),
            only: self.only.clone(),
            worlds: self.worlds.clone(),
            quick: self.quick,
            seeds: self.seeds,
            fresh: self.fresh,
            threads: self.threads,
            out: self.out.clone(),
        };
        let mut shown = TerminalWatch::resumable(BAR, self.fresh);
        if let Some(name) = &self.trace {
            let run = options.repeat(name, TraceKind::csv(self.csv), &mut shown)?;
            self.tell_run(&run);
            self.page.show(&run.folder.join("report.html"));
            return Ok(ExitCode::SUCCESS);
        }
        let answer = options.run(&mut shown)?;
        self.tell(&answer)?;
        self.page.show(&answer.page);
        let failed =
            outcomes(&answer.comparison).any(|outcome| matches!(outcome, RunOutcome::Panicked(_)));
        Ok(if failed { ExitCode::from(1) } else { ExitCode::SUCCESS })
    }

    fn tell_run(&self, run: &Repeated) {
        let file = |name: &str| run.folder.join(name);
        if self.json {
            let document = json!({
                "folder": run.folder,
                "report": file("report.html"),
                "ended": run.ended,
                "metrics": run.metrics,
            });
            println!("{document:#}");
            return;
        }
        if let Some(why) = &run.ended {
            println!("{why}");
        }
        println!("trace: {}", run.trace.display());
        println!("report: {}", file("report.html").display());
    }

    fn tell(&self, answer: &CompareAnswer) -> Result<(), Failure> {
        let CompareAnswer { comparison, folder, page } = answer;
        if !self.json {
            println!("{}", table::overview(comparison));
            println!("report: {}", page.display());
            return Ok(());
        }
        let losses = losses(comparison);
        let losses = serde_json::to_value(losses).map_err(Failure::plain)?;
        let document = json!({
            "folder": folder,
            "report": page,
            "arms": comparison.arms.iter().map(|arm| &arm.name).collect::<Vec<_>>(),
            "worlds": comparison.worlds.iter().map(|world| &world.name).collect::<Vec<_>>(),
            "rivals": comparison.rivals.iter().map(|rival| &rival.id).collect::<Vec<_>>(),
            "runs": outcomes(comparison).count(),
            "followed": outcomes(comparison).filter(|outcome| outcome.followed()).count(),
            "rows": comparison.rows.iter().map(table::row).collect::<Vec<_>>(),
            "losses": losses,
        });
        println!("{document:#}");
        Ok(())
    }
}

/// Outcomes of all runs.
fn outcomes(comparison: &Comparison) -> impl Iterator<Item = &RunOutcome> {
    let cells = comparison.rows.iter().flat_map(|row| &row.cells);
    cells.flat_map(|cell| &cell.runs).map(|run| &run.outcome)
}
