//! A comparison as a user asks for it, taken to its answer.

use std::path::{Path, PathBuf};

use phihat_campaign::{JOURNAL, Journal, results_of};
use phihat_rivals::Entry;
use phihat_session::{TraceKind, Watch, files, threads};

use crate::error::CompareError;
use crate::extent::ComparisonExtent;
use crate::page::comparison_page;
use crate::plan::ComparisonPlan;
use crate::record::Comparison;
use crate::repeat::{self, Repeated};

/// Options of a comparison.
#[derive(Debug, Clone, Default)]
pub struct CompareOptions {
    /// The study files (TOML), one per arm; the worlds are made from them.
    pub studies: Vec<PathBuf>,
    /// Laws of the caller, alongside those of the list.
    pub laws: Vec<&'static Entry>,
    /// Ids of the rivals; none: all.
    pub only: Vec<String>,
    /// Names of the worlds; none: all.
    pub worlds: Vec<String>,
    /// Few tuning runs, one motion of some seconds.
    pub quick: bool,
    /// Motions that are scored; `None`: 3, or 1 where `quick`.
    pub seeds: Option<u16>,
    /// Does everything again, whatever the journal holds.
    pub fresh: bool,
    /// Runs at a time; `None`: one per core.
    pub threads: Option<u16>,
    /// Folder for the results; `None`: `out/STUDY/compare`, or `out/compare` for several studies.
    pub out: Option<PathBuf>,
}

/// The answer of a comparison, and where it was written.
#[derive(Debug)]
pub struct CompareAnswer {
    /// The results.
    pub comparison: Comparison,
    /// The folder of the results.
    pub folder: PathBuf,
    /// The page.
    pub page: PathBuf,
}

impl CompareOptions {
    /// Folder of the results.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: the one study, whose name they take, cannot be read.
    pub fn folder(&self) -> Result<PathBuf, CompareError> {
        Ok(results_of(&self.studies, self.out.as_deref(), "compare")?)
    }

    /// Makes the comparison and writes its files; what its journal holds is not done again.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: an option or a study cannot be used, or a result not be written.
    pub fn run(&self, watch: &mut dyn Watch) -> Result<CompareAnswer, CompareError> {
        let folder = self.folder()?;
        let plan = ComparisonPlan::with(&self.studies, &self.laws, self.extent())?;
        let [data, page] = ["compare.json", "report.html"].map(|name| folder.join(name));
        let mut journal = self.journal(&folder, &[data.clone(), page.clone()], watch)?;
        let comparison = self.runs(&plan, &mut journal, watch)?;
        let text = serde_json::to_string(&comparison).map_err(CompareError::Answer)? + "\n";
        let html = comparison_page(&comparison, &self.command());
        files::write_locked(&[(data, text.into_bytes()), (page.clone(), html.into_bytes())])?;
        Ok(CompareAnswer { comparison, folder, page })
    }

    /// Repeats one run (`ARM/RIVAL/WORLD/default|tuned/SEED`) and writes its study, trace (as this kind of
    /// file) and report. It needs the gains of its rival on its arm alone: those that are not in the journal
    /// are found first.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: there is no such run, or it cannot begin.
    pub fn repeat(
        &self,
        name: &str,
        kind: TraceKind,
        watch: &mut dyn Watch,
    ) -> Result<Repeated, CompareError> {
        if !(self.only.is_empty() && self.worlds.is_empty()) {
            return Err(CompareError::OneRun);
        }
        let refuse = || CompareError::Run(name.to_owned());
        let [arm, rival, world, ..] = name.split('/').collect::<Vec<_>>()[..] else {
            return Err(refuse());
        };
        let (only, worlds) = (vec![rival.to_owned()], vec![world.to_owned()]);
        let mut plan = {
            let extent = ComparisonExtent { only, worlds, ..self.extent() };
            ComparisonPlan::with(&self.studies, &self.laws, extent)?
        };
        plan.arms.retain(|other| other.name == arm);
        if !plan.names().any(|known| known == name) {
            return Err(refuse());
        }
        let folder = self.folder()?;
        let mut journal = self.journal(&folder, &repeat::results(&folder, name, kind), watch)?;
        let comparison = self.runs(&plan, &mut journal, watch)?;
        let csv = if kind == TraceKind::Csv { " --csv" } else { "" };
        let command = format!("{} --trace {name}{csv}", self.command());
        repeat::keep(&plan, &comparison, (name, kind), &folder, &command)
    }

    fn extent(&self) -> ComparisonExtent {
        let whole = if self.quick { ComparisonExtent::quick() } else { ComparisonExtent::full() };
        let (only, worlds) = (self.only.clone(), self.worlds.clone());
        ComparisonExtent { only, worlds, seeds: self.seeds.map_or(whole.seeds, u64::from), ..whole }
    }

    /// Opens the journal, once it is sure that the results can be written; no other process writes there meanwhile.
    fn journal(
        &self,
        folder: &Path,
        results: &[PathBuf],
        watch: &mut dyn Watch,
    ) -> Result<Journal, CompareError> {
        let path = folder.join(JOURNAL);
        files::check_writable(results.iter().chain([&path]))?;
        Ok(Journal::in_folder(&path, self.fresh, watch)?)
    }

    fn runs(
        &self,
        plan: &ComparisonPlan,
        journal: &mut Journal,
        watch: &mut dyn Watch,
    ) -> Result<Comparison, CompareError> {
        watch.begun(&[]);
        let ended = plan.run(journal, threads(self.threads), |progress| {
            // A share of a thousand.
            let share = 1000.0 * plan.share_done(progress.done);
            watch.step(&format!("{} of {} jobs", progress.done, progress.all));
            watch.progress(format!("{share:.0}").parse().unwrap_or(0), 1000);
            if progress.done == progress.resumed {
                watch.resumed();
            }
        });
        watch.ended();
        ended
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
}
