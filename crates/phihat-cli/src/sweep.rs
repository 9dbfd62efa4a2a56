//! `phihat sweep` and `phihat merge`: a study many times, its numbers drawn anew in each run.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use comfy_table::CellAlignment;
use phihat_campaign::sweep::{
    Quantile, SweepAnswer, SweepOptions, SweepSummary, SweptWhole, merge,
};
use serde_json::json;

use crate::check::warn_of_renamed;
use crate::failure::Failure;
use crate::shown::TerminalWatch;
use crate::table::Fitted;
use crate::terminal::PageOptions;

/// Run a study many times with numbers drawn at random, and see what holds for how many runs.
///
/// Gains are made once, for the study as it stands. KEY is the path of any number of the study
/// (docs/study.md): world.payload.mass_kg, fault[0].size, gains.inertia_kg_m2[2],
/// world.coulomb_extra_nm.joint2. Writes runs.npy (a row per run, for NumPy), sweep.json, report.html and the
/// studies of the worst runs to out/STUDY/sweep/. An interrupted sweep goes on where it was.
#[derive(Debug, Args)]
#[command(after_help = "How a number varies:\n  \
    KEY=0..2              evenly between both; integers both included\n  \
    KEY=log:0.1..10       evenly on a logarithmic scale\n  \
    KEY=normal:1.5,0.2    normal: mean, standard deviation\n  \
    KEY=0.5,1,2           one of these\n  \
    KEY=times:0.8..1.2    what the study says there, times a number drawn so\n\n\
    Exit code 1: a run broke a stated bound, or did not come to its end.\n\nExamples:\n  \
    phihat sweep studies/first.toml --vary world.payload.mass_kg=0..1 --runs 100\n  \
    phihat sweep studies/first.toml --vary gains.inertia_kg_m2=times:log:0.5..2 --runs 100000 --shard 3/8")]
pub(crate) struct SweepVerb {
    /// The study (TOML).
    study: PathBuf,
    /// A number of the study, and how it varies; once for each.
    #[arg(long, value_name = "KEY=HOW", required = true)]
    vary: Vec<String>,
    /// How many runs, of all shards.
    #[arg(long, value_name = "N", default_value_t = 1000,
        value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    runs: u64,
    /// Decides what every run draws.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Only the K-th of N parts of the runs; `phihat merge` puts them together.
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,
    /// Gains in place of those that the study states or leaves to the design.
    #[arg(long, value_name = "FILE")]
    gains: Option<PathBuf>,
    /// Run gains even where they may not run on this arm.
    #[arg(long)]
    uncertified: bool,
    /// Do every run again, whatever the journal holds.
    #[arg(long)]
    fresh: bool,
    /// Runs at a time [default: one per core].
    #[arg(long, value_name = "J", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Folder for the results; a shard takes a folder in there.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    page: PageOptions,
}

/// Put the shards of a sweep together: what one process would have left, byte for byte.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 1: a run broke a stated bound, or did not come to its end.\n\nExamples:\n  \
    phihat merge out/first/sweep\n  \
    phihat merge a/shard-1-of-2 b/shard-2-of-2 --out out/whole"
)]
pub(crate) struct Merge {
    /// The folders of the shards, or one that has them all.
    #[arg(required = true)]
    folders: Vec<PathBuf>,
    /// Folder for the results; else the one that has the shards.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    page: PageOptions,
}

const BAR: &str = "{wide_bar} {pos} of {len} runs · {elapsed} · {eta} left";

impl SweepVerb {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        warn_of_renamed([&self.study]);
        let options = SweepOptions {
            study: self.study.clone(),
            gains: self.gains.clone(),
            vary: self.vary.clone(),
            runs: self.runs,
            seed: self.seed,
            shard: self.shard.clone(),
            fresh: self.fresh,
            uncertified: self.uncertified,
            threads: self.jobs,
            out: self.out.clone(),
        };
        match options.run(&mut TerminalWatch::resumable(BAR, self.fresh))? {
            SweepAnswer::Whole(swept) => Ok(tell(&swept, self.json, &self.page)),
            SweepAnswer::Shard { folder, runs } => {
                if self.json {
                    println!("{:#}", json!({ "folder": folder, "runs": runs }));
                } else {
                    println!("{runs} runs: {}", folder.display());
                }
                Ok(ExitCode::SUCCESS)
            }
        }
    }
}

impl Merge {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let swept = merge(&self.folders, self.out.as_deref())?;
        Ok(tell(&swept, self.json, &self.page))
    }
}

fn tell(swept: &SweptWhole, as_json: bool, page: &PageOptions) -> ExitCode {
    let SweptWhole { summary, folder, page: report } = swept;
    if as_json {
        let document = json!({ "folder": folder, "report": report, "sweep": summary });
        println!("{document:#}");
    } else {
        println!("{}", overview(summary));
        println!("report: {}", report.display());
    }
    page.show(report);
    let good = summary.totals.within_spec == summary.runs;
    if good { ExitCode::SUCCESS } else { ExitCode::from(1) }
}

/// One line per figure, then how the runs ended, and the worst one.
fn overview(summary: &SweepSummary) -> String {
    let mut table = Fitted::new(["figure", "unit", "50 %", "95 %", "99 %", "largest"]);
    for figure in &summary.figures {
        let at = |share: f64| {
            let found = figure.quantiles.iter().find(|q| (q.share - share).abs() < 1e-12);
            found.map_or("–".to_owned(), |Quantile { value, .. }| shown(*value))
        };
        let (name, unit) = (figure.name.clone(), figure.unit.clone());
        table.add_row([name, unit, at(0.5), at(0.95), at(0.99), shown(figure.largest)]);
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let totals = &summary.totals;
    let [low, high] = totals.within_spec_interval.map(|share| 100.0 * share);
    let mut lines = vec![format!(
        "runs that kept every bound: {} of {}; with {:.0} % confidence {low:.4} % to {high:.4} % do",
        totals.within_spec,
        totals.whole + totals.diverged + totals.stopped,
        100.0 * summary.confidence,
    )];
    let others = [
        ("diverged", totals.diverged),
        ("stopped by the robot", totals.stopped),
        ("could not be run", totals.refused),
        ("panicked, which is a bug", totals.panicked),
    ];
    let others = others.iter().filter(|(_, count)| *count > 0);
    lines.extend(others.map(|(what, count)| format!("{what}: {count}")));
    if let Some(worst) = summary.worst.first() {
        lines.push(format!(
            "worst run: {}; in the folder of the report: {}",
            worst.run, worst.command
        ));
    }
    format!("{table}\n{}", lines.join("\n"))
}

fn shown(value: f64) -> String {
    if value == f64::INFINITY { "not ended".to_owned() } else { format!("{value:.4e}") }
}
