//! `phihat fronts`: laws at equal noise and equal knowledge.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use comfy_table::CellAlignment;
use phihat_campaign::Shard;
use phihat_campaign::statistics::{Spread, Standing};
use phihat_compare::fronts::{AtCap, Fronts, FrontsAnswer, FrontsOptions};
use serde_json::json;

use crate::check::warn_of_renamed;
use crate::failure::Failure;
use crate::shown::TerminalWatch;
use crate::table::Fitted;
use crate::terminal::PageOptions;

/// Hold laws against each other at equal torque noise and equal knowledge, with statistics.
///
/// Every law is tuned from several random starts under each cap on its noise, in drawn worlds; other worlds
/// choose among its tunings, and others again judge, once. One law under two names says what chance does.
/// Writes journal.jsonl, fronts.json and report.html to out/STUDY/fronts/. The whole takes days on two cores:
/// an interrupted one goes on where it was, and shards may run anywhere.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    phihat fronts studies/table1.toml --quick --only pd,industrial-pid,proposed-1\n  \
    phihat fronts studies/table1_panda.toml --count\n  \
    phihat fronts studies/table1_panda.toml --shard 1/8\n  \
    phihat fronts studies/table1_panda.toml --from out/table1_panda/fronts/shard-1-of-8 --from \
    out/table1_panda/fronts/shard-2-of-8")]
pub(crate) struct FrontsVerb {
    /// The study (TOML): its arm, its loop, its sensors.
    study: PathBuf,
    /// A study whose arm nothing is tuned on; the chosen gains run there too.
    #[arg(long, value_name = "STUDY")]
    held_out: Option<PathBuf>,
    /// Only these laws (`phihat compare --list`).
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    only: Vec<String>,
    #[command(flatten)]
    much: HowMuch,
    /// Print how many searches and runs it is, and do nothing.
    #[arg(long)]
    count: bool,
    /// Only the K-th of N parts of the searches.
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,
    /// Take over the searches of a shard: its folder or its journal; once for each.
    #[arg(long, value_name = "FOLDER")]
    from: Vec<PathBuf>,
    /// Do everything again, whatever the journal holds.
    #[arg(long)]
    fresh: bool,
    /// Searches at a time [default: one per core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Folder for the results; a shard takes a folder in there.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    page: PageOptions,
}

/// How much is done.
#[derive(Debug, Args)]
struct HowMuch {
    /// Few of everything: to see the page.
    #[arg(long)]
    quick: bool,
    /// Caps on the rms of the torque above 50 Hz, over the torque limit [default: 0.0005,0.001,0.002,0.005,0.01].
    #[arg(long, value_name = "SHARE", value_delimiter = ',')]
    caps: Vec<f64>,
    /// Searches of each law, each under all caps [default: 10].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    restarts: Option<u16>,
    /// Evaluations of a search for each free scalar and one more; under every cap but the loosest a quarter
    /// [default: 200].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    per_scalar: Option<u32>,
    /// Worlds to train in, to choose by, to be judged in [default: 20,20,50].
    #[arg(long, value_name = "A,B,C")]
    worlds: Option<String>,
    /// Decides all that is drawn [default: 1].
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
}

const BAR: &str = "{wide_bar} {pos} of {len} searches · {elapsed} · {eta} left";

/// `20,20,50`
fn three(text: &str) -> Result<[u32; 3], Failure> {
    let parts: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let counts = parts.and_then(|parts| <[u32; 3]>::try_from(parts).ok());
    let valid = |counts: &[u32; 3]| counts.iter().all(|n| (1..=10_000).contains(n));
    counts.filter(valid).ok_or_else(|| {
        Failure::plain(format!(
            "--worlds {text}: three whole numbers from 1 to 10000 are valid, such as 20,20,50"
        ))
    })
}

/// `3/8`
fn shard(text: &str) -> Result<Shard, Failure> {
    let why = || format!("--shard {text}: K/N with 1 ≤ K ≤ N ≤ 100000 is valid, such as 3/8");
    Shard::parse(text).ok_or_else(|| Failure::plain(why()))
}

impl FrontsVerb {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        warn_of_renamed([&self.study]);
        let options = FrontsOptions {
            study: self.study.clone(),
            held_out: self.held_out.clone(),
            only: self.only.clone(),
            quick: self.much.quick,
            caps: self.much.caps.clone(),
            restarts: self.much.restarts,
            per_scalar: self.much.per_scalar,
            worlds: self.much.worlds.as_deref().map(three).transpose()?,
            seed: self.much.seed,
            shard: self.shard.as_deref().map(shard).transpose()?,
            from: self.from.clone(),
            fresh: self.fresh,
            threads: self.threads,
            out: self.out.clone(),
        };
        if self.count {
            let plan = options.plan()?;
            let (searches, runs) = plan.size();
            let seconds = runs as f64 * plan.extent.span.0;
            if self.json {
                let document =
                    json!({ "searches": searches, "runs": runs, "simulated_s": seconds });
                println!("{document:#}");
            } else {
                println!(
                    "{searches} searches, some {runs} runs, {:.1} hours simulated",
                    seconds / 3600.0
                );
            }
            return Ok(ExitCode::SUCCESS);
        }
        match options.run(&mut TerminalWatch::resumable(BAR, self.fresh))? {
            FrontsAnswer::Whole { fronts, folder, page } => {
                if self.json {
                    let document = json!({ "folder": folder, "report": page, "fronts": *fronts });
                    println!("{document:#}");
                } else {
                    println!("{}", overview(&fronts));
                    println!("report: {}", page.display());
                }
                self.page.show(&page);
                let panicked =
                    fronts.points.iter().flat_map(|point| &point.restarts).any(|restart| {
                        restart.failed.as_deref().is_some_and(|why| why.contains("panicked"))
                    });
                Ok(if panicked { ExitCode::from(1) } else { ExitCode::SUCCESS })
            }
            FrontsAnswer::Shard { journal, searches } => {
                if self.json {
                    println!("{:#}", json!({ "journal": journal, "searches": searches }));
                } else {
                    println!("{searches} searches: {}", journal.display());
                }
                Ok(ExitCode::SUCCESS)
            }
        }
    }
}

/// A line per law and cap.
fn overview(fronts: &Fronts) -> String {
    let mut table = Fitted::new([
        "law",
        "cap [%]",
        "noise [%]",
        "error [mrad]",
        "not followed [%]",
        "errors over ours",
    ]);
    for point in &fronts.points {
        table.add_row(row(fronts, point));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let bands = fronts.extent.caps.iter().zip(&fronts.placebo);
    let bands = bands.filter(|(_, band)| band.pairs > 0);
    let bands: Vec<String> =
        bands.map(|(cap, band)| format!("{} %: {:.2}", 100.0 * cap, band.factor)).collect();
    let told = if bands.is_empty() {
        String::new()
    } else {
        let bands = bands.join(", ");
        format!("; one law under two names differs by up to a factor, at a cap of {bands}")
    };
    format!("{table}\nmedians in the test worlds{told}")
}

fn row(fronts: &Fronts, point: &AtCap) -> [String; 6] {
    let chosen = point.chosen.as_ref();
    let median = |spread: Option<Spread>, times: f64| {
        spread.map_or("–".to_owned(), |spread| format!("{:.4}", times * spread.median))
    };
    let versus = fronts
        .versus
        .iter()
        .find(|one| one.law == point.law && one.cap.total_cmp(&point.cap).is_eq());
    let versus = versus.map_or("–".to_owned(), |one| {
        let word = match one.standing {
            Standing::Better => "better",
            Standing::Worse => "worse",
            Standing::Alike => "no difference",
        };
        format!("{:.2}, {word}", one.ratio.ratio)
    });
    [
        point.law.clone(),
        (100.0 * point.cap).to_string(),
        median(chosen.and_then(|chosen| chosen.noise), 100.0),
        median(chosen.and_then(|chosen| chosen.error_rad), 1e3),
        chosen.map_or("–".to_owned(), |chosen| format!("{:.0}", 100.0 * chosen.failed)),
        versus,
    ]
}
