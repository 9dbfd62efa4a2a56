//! `phihat faults`: everything that can break, broken, one run each; and what became of the arm.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::available_parallelism;

use clap::{Args, Parser};
use comfy_table::presets::UTF8_BORDERS_ONLY;
use comfy_table::{CellAlignment, Table};
use indicatif::{ProgressBar, ProgressStyle};
use phihat_campaign::faults::{Case, Extent, Matrix, Summary};
use phihat_campaign::{Journal, run_all};
use phihat_design::Gains;
use phihat_study::Study;
use serde_json::json;

use crate::failure::Failure;
use crate::record::Session;
use crate::{files, interrupt, knowledge};

/// Break everything an arm can meet, one fault at a time, and see what becomes of it.
///
/// Every run is the study, under the supervisor, with one fault of one severity: sensors, drives, network, clock, load, friction,
/// limits. Writes journal.jsonl, faults.json and report.html to out/STUDY/faults/ (out/faults/ for several
/// studies). An interrupted matrix goes on where it was.
#[derive(Debug, Args)]
#[command(after_help = "Exit code 1: a bar was missed.\n\nExamples:\n  \
    phihat faults studies/panda_design.toml --quick\n  \
    phihat faults studies/faults/*.toml\n  \
    phihat faults studies/faults/panda.toml --only panda/m2/freeze/3/1 --trace")]
#[allow(clippy::struct_excessive_bools, reason = "independent switches of a command line")]
pub(crate) struct Faults {
    /// The studies (TOML), one per arm; without faults of their own.
    #[arg(required = true)]
    studies: Vec<PathBuf>,
    /// Estimator orders, each with its own gains.
    #[arg(long, value_name = "M", value_delimiter = ',', default_value = "1,2")]
    orders: Vec<usize>,
    /// Seeds per fault and severity: onset, joint, sign and noise differ.
    #[arg(long, default_value_t = 3, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=10_000))]
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
    /// Do every run again, whatever the journal holds.
    #[arg(long)]
    fresh: bool,
    /// Runs at a time [default: one per core].
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Folder for the results.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
}

/// Runs whose traces are kept at most: some 3 MB each.
const TRACES_MAX: usize = 20;

impl Faults {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let (matrix, folder) = self.matrix()?;
        let (summary, page) = self.answer(&matrix, &folder)?;
        self.tell(&summary, &folder, &page);
        Ok(if summary.totals.good { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }

    /// The runs that are asked for, and where their results go.
    fn matrix(&self) -> Result<(Matrix, PathBuf), Failure> {
        if let Some(order) = self.orders.iter().find(|m| !(1..=phihat::ORDER_MAX).contains(*m)) {
            let message = format!("--orders {order}: orders are 1 to {}", phihat::ORDER_MAX);
            return Err(Failure::plain(message));
        }
        let folder = self.folder()?;
        let mut extent = Extent {
            orders: self.orders.clone(),
            seeds: u64::from(self.seeds),
            only: self.only.clone(),
        };
        if self.quick {
            extent.orders.truncate(1);
            extent.seeds = 1;
        }
        let cache = folder.join("gains");
        let matrix =
            Matrix::new(&self.studies, &extent, &cache, &gains_of).map_err(|e| told(&e))?;
        if self.trace && matrix.cases.len() > TRACES_MAX {
            let runs = matrix.cases.len();
            let message = format!("--trace: {runs} runs; choose {TRACES_MAX} at most with --only");
            return Err(Failure::plain(message));
        }
        Ok((matrix, folder))
    }

    /// Runs them and writes the answer, whose page is named.
    fn answer(&self, matrix: &Matrix, folder: &Path) -> Result<(Summary, PathBuf), Failure> {
        let cache = folder.join("gains");
        let [path, data, page] =
            ["journal.jsonl", "faults.json", "report.html"].map(|name| folder.join(name));
        files::check_writable([&path, &data, &page, &cache.join("gains.json")])?;
        let mut journal = files::open_journal(&path, self.fresh)?;
        for (name, gains) in matrix.arms.iter().flat_map(phihat_campaign::faults::Arm::gains) {
            let text = gains.to_json().map_err(Failure::plain)?;
            files::write_locked(&[(cache.join(name), text.into_bytes())])?;
        }
        let summary = self.run(matrix, &mut journal, &path)?;
        let text = serde_json::to_string_pretty(&summary).map_err(Failure::plain)?;
        let html = phihat_report::faults_page(&summary, &self.command());
        files::write_locked(&[
            (data, (text + "\n").into_bytes()),
            (page.clone(), html.into_bytes()),
        ])?;
        if self.trace {
            for case in &matrix.cases {
                keep(matrix, case, folder)?;
            }
        }
        Ok((summary, page))
    }

    /// Where the results go.
    fn folder(&self) -> Result<PathBuf, Failure> {
        if let Some(folder) = &self.out {
            return Ok(folder.clone());
        }
        match self.studies.as_slice() {
            [one] => {
                let study = knowledge::read(one)?;
                Ok(Path::new("out").join(study.name).join("faults"))
            }
            _ => Ok(Path::new("out").join("faults")),
        }
    }

    fn run(&self, matrix: &Matrix, journal: &mut Journal, path: &Path) -> Result<Summary, Failure> {
        let ids: Vec<String> = matrix.cases.iter().map(|case| matrix.id(case)).collect();
        let cores = available_parallelism().map_or(1, usize::from);
        let bar = ProgressBar::new(ids.len() as u64);
        interrupt::says(&bar, interrupt::resumable(path, self.fresh));
        let template = "{wide_bar} {pos} of {len} runs · {elapsed} · {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let ended = run_all(
            &ids,
            journal,
            self.threads.map_or(cores, usize::from),
            &|place| matrix.run(&matrix.cases[place]),
            |progress| {
                if progress.done == progress.resumed {
                    // What was done before says nothing about the time left.
                    bar.set_position(progress.done as u64);
                    bar.reset_eta();
                }
                bar.set_position(progress.done as u64);
            },
        )
        .map_err(Failure::plain)?;
        bar.finish_and_clear();
        Ok(Summary::new(matrix, ended))
    }

    /// The command that repeats one run of these studies, but for the run's name.
    fn command(&self) -> String {
        let studies: Vec<_> = self.studies.iter().map(|s| s.display().to_string()).collect();
        let mut command = format!("phihat faults {}", studies.join(" "));
        if let Some(folder) = &self.out {
            command = format!("{command} --out {}", folder.display());
        }
        command
    }

    fn tell(&self, summary: &Summary, folder: &Path, page: &Path) {
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

/// The fault matrix as `phihat faults` runs it with these arguments, and its answer.
///
/// # Errors
///
/// [`Failure`]: an argument or a study cannot be used, or a result not be written.
pub fn fault_matrix(arguments: impl IntoIterator<Item = OsString>) -> Result<Summary, Failure> {
    #[derive(Debug, Parser)]
    #[command(no_binary_name = true)]
    struct Only {
        #[command(flatten)]
        faults: Faults,
    }
    let Only { faults } = Only::try_parse_from(arguments).map_err(Failure::plain)?;
    let (matrix, folder) = faults.matrix()?;
    Ok(faults.answer(&matrix, &folder)?.0)
}

/// A study's error is laid out with its line already.
fn told(error: &impl ToString) -> Failure {
    let text = error.to_string();
    if text.starts_with("error") { Failure::rendered(text) } else { Failure::plain(text) }
}

/// The gains that a study states, else designed ones; they may run on its arm.
fn gains_of(study: &Study, path: &Path) -> Result<Gains, String> {
    let session = Session::new(Box::new(study.clone()), path, None, false);
    session.map(Session::into_gains).map_err(|e| e.to_string())
}

/// Repeats a run with everything it leaves: study, gains, trace, report.
fn keep(matrix: &Matrix, case: &Case, folder: &Path) -> Result<(), Failure> {
    let folder = folder.join("runs").join(matrix.name(case).to_string());
    let study = Box::new(matrix.study(case).map_err(Failure::plain)?);
    let gains = folder.join("gains.json");
    let given = Some((matrix.gains(case).clone(), gains.as_path()));
    let session = Session::new(study, &folder.join("study.toml"), given, true)?;
    session.simulate(&folder, Some(&folder.join("report.html"))).map(|_| ())
}

/// One line per fault, what each severity came to, and the totals.
fn overview(summary: &Summary) -> String {
    let mut table = Table::new();
    table.load_style(UTF8_BORDERS_ONLY);
    table.set_header(["row", "fault", "mild", "medium", "severe", "worst excursion"]);
    for fault in &summary.faults {
        let runs = || summary.runs.iter().filter(|run| run.fault == fault.name);
        let level = |severity: usize| {
            let of: Vec<_> = runs().filter(|run| run.severity == severity).collect();
            let kept = of.iter().filter(|run| run.missed.is_empty()).count();
            format!("{kept}/{}", of.len())
        };
        let worst = runs().filter_map(|run| run.cell()).map(|cell| cell.excursion_rad);
        let worst = format!("{:.2} mrad", 1e3 * worst.fold(0.0, f64::max));
        let name = fault.name.clone();
        table.add_row([fault.row.clone(), name, level(1), level(2), level(3), worst]);
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
