//! `phihat compare`: the rivals of the paper's Table 1, measured on the same arms under the same terms.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::available_parallelism;

use clap::{Args, Parser};
use indicatif::{ProgressBar, ProgressStyle};
use phihat_baselines::RIVALS;
use phihat_campaign::Journal;
use phihat_campaign::compare::{CompareError, Comparison, Extent, Fate, Plan, WORLDS};
use serde_json::json;

use crate::failure::Failure;
use crate::{files, interrupt, knowledge};

mod list;
mod table;
mod trial;

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
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=1000))]
    seeds: Option<u16>,
    /// Repeat this one run (ARM/RIVAL/WORLD/default|tuned/SEED) and keep its study, trace and report.
    #[arg(long, value_name = "RUN")]
    trace: Option<String>,
    /// Do everything again, whatever the journal holds.
    #[arg(long)]
    fresh: bool,
    /// Runs at a time [default: one per core].
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Folder for the results.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of tables.
    #[arg(long)]
    json: bool,
}

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
        if let Some(name) = &self.trace {
            return self.repeat(name);
        }
        let folder = self.folder()?;
        let (comparison, page) = self.answer(&folder)?;
        self.tell(&comparison, &folder, &page)?;
        let failed = fates(&comparison).any(|fate| matches!(fate, Fate::Panicked(_)));
        Ok(if failed { ExitCode::from(1) } else { ExitCode::SUCCESS })
    }

    /// Makes the comparison and leaves its files; says where the page is.
    fn answer(&self, folder: &Path) -> Result<(Comparison, PathBuf), Failure> {
        let plan = self.plan(self.extent())?;
        let mut journal = self.journal(folder, &results(folder))?;
        let comparison = self.run(&plan, folder, &mut journal)?;
        let page = write(&comparison, folder, &self.command())?;
        Ok((comparison, page))
    }

    fn extent(&self) -> Extent {
        let whole = if self.quick { Extent::quick() } else { Extent::full() };
        let (only, worlds) = (self.only.clone(), self.worlds.clone());
        Extent { only, worlds, seeds: self.seeds.map_or(whole.seeds, u64::from), ..whole }
    }

    fn plan(&self, extent: Extent) -> Result<Plan, Failure> {
        Plan::new(&self.studies, extent).map_err(|e| unusable(&e))
    }

    /// One run again. It needs its rival's gains on its arm, and those alone: what the journal does not hold of
    /// them is done first.
    fn repeat(&self, name: &str) -> Result<ExitCode, Failure> {
        if !(self.only.is_empty() && self.worlds.is_empty()) {
            let why = "--trace names one run, with its rival and its world: leave out --only and --worlds";
            return Err(Failure::plain(why));
        }
        let refuse = || unusable(&CompareError::Run(name.to_owned()));
        let [arm, rival, world, ..] = name.split('/').collect::<Vec<_>>()[..] else {
            return Err(refuse());
        };
        let (only, worlds) = (vec![rival.to_owned()], vec![world.to_owned()]);
        let mut plan = self.plan(Extent { only, worlds, ..self.extent() })?;
        plan.grounds.retain(|ground| ground.name == arm);
        if !plan.names().any(|known| known == name) {
            return Err(refuse());
        }
        let folder = self.folder()?;
        let mut journal = self.journal(&folder, &trial::results(&folder, name))?;
        let comparison = self.run(&plan, &folder, &mut journal)?;
        let command = format!("{} --trace {name}", self.command());
        let done = trial::keep(&plan, &comparison, name, &folder, &command)?;
        if self.json {
            println!("{:#}", done.document());
        } else {
            println!("{done}");
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Where the results go.
    fn folder(&self) -> Result<PathBuf, Failure> {
        if let Some(folder) = &self.out {
            return Ok(folder.clone());
        }
        match self.studies.as_slice() {
            [one] => {
                let study = knowledge::read(one)?;
                Ok(Path::new("out").join(study.name).join("compare"))
            }
            _ => Ok(Path::new("out").join("compare")),
        }
    }

    /// Opens the journal, once it is sure that the results can be written; no other process writes there meanwhile.
    fn journal(&self, folder: &Path, results: &[PathBuf]) -> Result<Journal, Failure> {
        let path = folder.join(JOURNAL);
        files::check_writable(results.iter().chain([&path]))?;
        files::open_journal(&path, self.fresh)
    }

    /// Does what is asked for.
    fn run(
        &self,
        plan: &Plan,
        folder: &Path,
        journal: &mut Journal,
    ) -> Result<Comparison, Failure> {
        let cores = available_parallelism().map_or(1, usize::from);
        let threads = self.threads.map_or(cores, usize::from);
        let bar = ProgressBar::new(1000);
        let template = "{wide_bar} {percent} % · {msg} · {elapsed} · {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        interrupt::says(&bar, interrupt::resumable(&folder.join(JOURNAL), self.fresh));
        let ended = plan.run(journal, threads, |progress| {
            // A share of a thousand.
            let share = 1000.0 * plan.share_done(progress.done);
            bar.set_position(format!("{share:.0}").parse().unwrap_or(0));
            bar.set_message(format!("{} of {} jobs", progress.done, progress.all));
            if progress.done == progress.resumed {
                // What was done before says nothing about the time left.
                bar.reset_eta();
            }
        });
        bar.finish_and_clear();
        ended.map_err(|e| unusable(&e))
    }

    /// The command that makes the comparison again.
    fn command(&self) -> String {
        let mut words: Vec<String> = vec!["phihat compare".to_owned()];
        words.extend(self.studies.iter().map(|study| study.display().to_string()));
        words.extend(self.quick.then(|| "--quick".to_owned()));
        words.extend(self.seeds.map(|seeds| format!("--seeds {seeds}")));
        words.extend(self.out.as_ref().map(|folder| format!("--out {}", folder.display())));
        words.join(" ")
    }

    fn tell(&self, comparison: &Comparison, folder: &Path, page: &Path) -> Result<(), Failure> {
        if !self.json {
            println!("{}", table::overview(comparison));
            println!("report: {}", page.display());
            return Ok(());
        }
        let losses = phihat_report::losses(comparison);
        let losses = serde_json::to_value(losses).map_err(Failure::plain)?;
        let document = json!({
            "folder": folder,
            "report": page,
            "arms": comparison.arms.iter().map(|arm| &arm.name).collect::<Vec<_>>(),
            "worlds": comparison.worlds.iter().map(|world| &world.name).collect::<Vec<_>>(),
            "rivals": comparison.rivals.iter().map(|rival| &rival.id).collect::<Vec<_>>(),
            "runs": fates(comparison).count(),
            "followed": fates(comparison).filter(|fate| fate.followed()).count(),
            "rows": comparison.rows.iter().map(table::row).collect::<Vec<_>>(),
            "losses": losses,
        });
        println!("{document:#}");
        Ok(())
    }
}

/// The comparison that `phihat compare` makes with these arguments, its files left.
///
/// # Errors
///
/// [`Failure`]: an argument or a study cannot be used, or a result not be written.
pub fn comparison(arguments: impl IntoIterator<Item = OsString>) -> Result<Comparison, Failure> {
    #[derive(Debug, Parser)]
    #[command(no_binary_name = true)]
    struct Only {
        #[command(flatten)]
        compare: Compare,
    }
    let Only { compare } = Only::try_parse_from(arguments).map_err(Failure::plain)?;
    Ok(compare.answer(&compare.folder()?)?.0)
}

/// What became of every run.
fn fates(comparison: &Comparison) -> impl Iterator<Item = &Fate> {
    let cells = comparison.rows.iter().flat_map(|row| &row.cells);
    cells.flat_map(|cell| &cell.runs).map(|run| &run.fate)
}

/// The answer and its page.
fn results(folder: &Path) -> [PathBuf; 2] {
    ["compare.json", "report.html"].map(|name| folder.join(name))
}

const JOURNAL: &str = "journal.jsonl";

/// Writes both or neither; the page is named.
fn write(comparison: &Comparison, folder: &Path, command: &str) -> Result<PathBuf, Failure> {
    let [data, page] = results(folder);
    let text = serde_json::to_string(comparison).map_err(Failure::plain)? + "\n";
    let html = phihat_report::comparison_page(comparison, command);
    files::write_locked(&[(data, text.into_bytes()), (page.clone(), html.into_bytes())])?;
    Ok(page)
}

/// A name that there is not, with the nearest one that there is; or what else is wrong.
fn unusable(error: &CompareError) -> Failure {
    let ids = || RIVALS.iter().map(|entry| entry.card.id);
    let worlds = || WORLDS.iter().map(|world| world.name);
    match error {
        CompareError::Rival(id) => Failure::plain(format!(
            "there is no rival `{id}`{}; `phihat compare --list` lists them",
            hint(id, ids())
        )),
        CompareError::World(name) => {
            let all: Vec<_> = worlds().collect();
            let hint = hint(name, worlds());
            Failure::plain(format!(
                "there is no world `{name}`{hint}; there are {}",
                all.join(", ")
            ))
        }
        // A study's error is laid out with its line already.
        CompareError::Study(text) if text.starts_with("error") => Failure::rendered(text),
        other => Failure::plain(other),
    }
}

/// The known name closest to another, if it is close.
fn hint<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let scored = known.map(|known| (strsim::jaro_winkler(name, known), known));
    let best = scored.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(score, _)| *score > 0.6);
    best.map_or_else(String::new, |(_, known)| format!(", did you mean `{known}`?"))
}
