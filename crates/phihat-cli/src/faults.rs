//! `phihat faults`: everything that can break, broken, one run each; and what became of the arm.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use comfy_table::CellAlignment;
use phihat_campaign::faults::{FaultsAnswer, FaultsOptions, Summary};
use phihat_session::TraceKind;
use serde_json::json;

use crate::check::warn_of_renamed;
use crate::failure::Failure;
use crate::shown::TerminalWatch;
use crate::table::Fitted;
use crate::terminal::PageOptions;

/// Break everything an arm can meet, one fault at a time, and see what becomes of it.
///
/// Every run is the study, under the supervisor, with one fault of one severity: sensors, drives, network,
/// clock, load, friction, limits. Writes journal.jsonl, faults.json and report.html to out/STUDY/faults/
/// (out/faults/ for several studies). An interrupted matrix goes on where it was.
#[derive(Debug, Args)]
#[command(after_help = "Exit code 1: a bar was missed.\n\nExamples:\n  \
    phihat faults studies/panda_design.toml --quick\n  \
    phihat faults studies/faults/*.toml\n  \
    phihat faults studies/faults/panda.toml --only panda/m2/freeze/3/1 --trace")]
#[allow(clippy::struct_excessive_bools, reason = "independent switches of a command line")]
pub(crate) struct FaultsVerb {
    /// The studies (TOML), one per arm; without faults of their own.
    #[arg(required = true)]
    studies: Vec<PathBuf>,
    /// Estimator orders, each with its own gains.
    #[arg(long, value_name = "M", value_delimiter = ',', default_value = "1,2")]
    orders: Vec<usize>,
    /// Seeds per fault and severity: onset, joint, sign and noise differ.
    #[arg(long, default_value_t = 3,
        value_parser = clap::value_parser!(u16).range(1..=10_000))]
    seeds: u16,
    /// One order, one seed.
    #[arg(long)]
    quick: bool,
    /// Only runs whose name (ARM/mORDER/FAULT/SEVERITY/SEED) contains this.
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Keep study, trace and report of every run; for 20 runs at most.
    #[arg(long)]
    trace: bool,
    /// With --trace: as a text, trace.csv, in place of trace.parquet.
    #[arg(long, requires = "trace")]
    csv: bool,
    /// Do every run again, whatever the journal holds.
    #[arg(long)]
    fresh: bool,
    /// Runs at a time [default: one per core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Folder for the results.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    page: PageOptions,
}

impl FaultsVerb {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        warn_of_renamed(&self.studies);
        let options = FaultsOptions {
            studies: self.studies.clone(),
            orders: self.orders.clone(),
            seeds: self.seeds,
            quick: self.quick,
            only: self.only.clone(),
            trace: self.trace.then(|| TraceKind::csv(self.csv)),
            fresh: self.fresh,
            threads: self.threads,
            out: self.out.clone(),
        };
        let mut shown = TerminalWatch::resumable(BAR, self.fresh);
        let answer = options.run(&mut shown)?;
        self.tell(&answer);
        self.page.show(&answer.page);
        let good = answer.summary.totals.good;
        Ok(if good { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }

    fn tell(&self, answer: &FaultsAnswer) {
        let FaultsAnswer { summary, folder, page } = answer;
        if self.json {
            let document = json!({
                "folder": folder,
                "report": page,
                "totals": summary.totals,
                "missed": summary.runs.iter().filter(|run| !run.missed.is_empty()).collect::<Vec<_>>(),
            });
            println!("{document:#}");
        } else {
            println!("{}", overview(summary));
            println!("report: {}", page.display());
        }
    }
}

const BAR: &str = "{wide_bar} {pos} of {len} runs · {elapsed} · {eta} left";

/// One line per fault, what each severity came to, and the totals.
fn overview(summary: &Summary) -> String {
    let mut table =
        Fitted::new(["fault", "what it is", "mild", "medium", "severe", "worst excursion"]);
    for fault in &summary.faults {
        let runs = || summary.runs.iter().filter(|run| run.fault == fault.name);
        let level = |severity: usize| {
            let of: Vec<_> = runs().filter(|run| run.severity == severity).collect();
            let kept = of.iter().filter(|run| run.missed.is_empty()).count();
            format!("{kept}/{}", of.len())
        };
        let cells = runs().filter_map(|run| run.cell());
        let worst = cells.max_by(|a, b| a.excursion_rad.total_cmp(&b.excursion_rad));
        let worst = worst.map_or_else(String::new, |cell| {
            format!("{:.2} {}", 1e3 * cell.excursion_rad, cell.way_unit)
        });
        // Its name with blanks, and the sentence in which the matrix says what it is.
        let name = fault.name.replace('_', " ");
        table.add_row([name, fault.what.clone(), level(1), level(2), level(3), worst]);
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let totals = &summary.totals;
    let parts = [
        ("panicked or could not run", totals.panicked),
        ("not finite", totals.not_finite),
        ("beyond a torque or rate limit", totals.beyond_limits),
        ("stopped falsely, or late after the reason", totals.bad_stops),
        ("stopped or went on against their bar", totals.wrong_ends),
        ("beyond their excursion's bar", totals.beyond_excursion),
    ];
    let lines = parts.map(|(what, count)| format!("{what}: {count}"));
    let kept = format!("runs that kept their bars: {} of {}", totals.kept, totals.runs);
    format!("{table}\n{kept}\n{}", lines.join("\n"))
}
