//! A comparison at equal noise as a user asks for it, taken to its answer.

use std::path::{Path, PathBuf};

use phihat_campaign::{JOURNAL, Journal, Shard, results_of};
use phihat_session::{Watch, files, threads};

use super::extent::FrontsExtent;
use super::page::fronts_page;
use super::plan::FrontsPlan;
use super::record::Fronts;
use crate::error::CompareError;

/// Options of a comparison at equal noise. What is `None` is as in the whole comparison, or as `quick` has it.
#[derive(Debug, Clone, Default)]
pub struct FrontsOptions {
    /// The study file (TOML): its arm, and what it says of loop and sensors.
    pub study: PathBuf,
    /// Another study, on whose arm nothing is tuned.
    pub held_out: Option<PathBuf>,
    /// Ids of the laws; none: all.
    pub only: Vec<String>,
    /// Few of everything.
    pub quick: bool,
    /// Caps on noise, over the torque limit; none: .0005, .001, .002, .005, .01.
    pub caps: Vec<f64>,
    /// Searches of each law at each cap.
    pub restarts: Option<u16>,
    /// Evaluations of a search for each free scalar and one more.
    pub per_scalar: Option<u32>,
    /// Worlds to train in, to choose by, to be judged in.
    pub worlds: Option<[u32; 3]>,
    /// Decides all that is drawn.
    pub seed: Option<u64>,
    /// One part of the searches.
    pub shard: Option<Shard>,
    /// Journals of shards, whose searches are taken over.
    pub from: Vec<PathBuf>,
    /// Does everything again, whatever the journal holds.
    pub fresh: bool,
    /// Searches at a time; `None`: one per core.
    pub threads: Option<u16>,
    /// Folder for the results; `None`: `out/STUDY/fronts`.
    pub out: Option<PathBuf>,
}

/// Result of a comparison at equal noise.
#[derive(Debug)]
pub enum FrontsAnswer {
    /// All of it.
    Whole {
        /// The results.
        fronts: Box<Fronts>,
        /// The folder of the results.
        folder: PathBuf,
        /// The page.
        page: PathBuf,
    },
    /// A shard, whose searches are all in its journal.
    Shard {
        /// The journal.
        journal: PathBuf,
        /// Its searches.
        searches: usize,
    },
}

impl FrontsOptions {
    /// Extent of the comparison.
    ///
    /// # Errors
    ///
    /// [`CompareError::Begin`]: a cap that is not between 0 and 1, or no world of a kind.
    pub fn extent(&self) -> Result<FrontsExtent, CompareError> {
        let mut extent = if self.quick { FrontsExtent::quick() } else { FrontsExtent::full() };
        if !self.caps.is_empty() {
            extent.caps.clone_from(&self.caps);
            extent.caps.sort_by(f64::total_cmp);
            extent.caps.dedup();
        }
        extent.restarts = self.restarts.map_or(extent.restarts, u64::from);
        extent.per_scalar = self.per_scalar.map_or(extent.per_scalar, |n| n as usize);
        extent.worlds = self.worlds.unwrap_or(extent.worlds);
        extent.seed = self.seed.unwrap_or(extent.seed);
        if let Some(cap) = extent.caps.iter().find(|cap| !(**cap > 0.0 && **cap < 1.0)) {
            let why = format!(
                "a cap of {cap} on noise: a share of the torque limit between 0 and 1 is valid"
            );
            return Err(CompareError::Begin(why.into()));
        }
        if extent.worlds.contains(&0) || extent.restarts == 0 || extent.per_scalar == 0 {
            let why = "at least one world of each kind, one restart and one evaluation are needed";
            return Err(CompareError::Begin(why.into()));
        }
        Ok(extent)
    }

    /// Folder of the results; that of a shard is a folder of its own inside of it.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: the study, whose name they take, cannot be read.
    pub fn folder(&self) -> Result<PathBuf, CompareError> {
        let studies = std::slice::from_ref(&self.study);
        let folder = results_of(studies, self.out.as_deref(), "fronts")?;
        let own = self.shard.map(|Shard { part, of }| format!("shard-{part}-of-{of}"));
        Ok(own.map_or(folder.clone(), |own| folder.join(own)))
    }

    /// The plan.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: an option or a study cannot be used.
    pub fn plan(&self) -> Result<FrontsPlan, CompareError> {
        FrontsPlan::new(&self.study, self.held_out.as_ref(), &self.only, self.extent()?)
    }

    /// Does what the journal does not hold, and writes the answer.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: an option or a study cannot be used, or a result not be written.
    pub fn run(&self, watch: &mut dyn Watch) -> Result<FrontsAnswer, CompareError> {
        let plan = self.plan()?;
        let folder = self.folder()?;
        let places = [JOURNAL, "fronts.json", "report.html"].map(|name| folder.join(name));
        files::check_writable(&places)?;
        let [path, data, page] = places;
        let mut journal = Journal::in_folder(&path, self.fresh, watch)?;
        for other in &self.from {
            take_over(&mut journal, other)?;
        }
        watch.begun(&[]);
        let (shard, count) = (self.shard.unwrap_or(Shard::WHOLE), threads(self.threads));
        let mut searches = 0;
        let done = plan.run(&mut journal, shard, count, |progress| {
            searches = progress.all;
            watch.step(&format!("{} of {} searches", progress.done, progress.all));
            watch.progress(progress.done as u64, progress.all as u64);
            if progress.done == progress.resumed {
                watch.resumed();
            }
        });
        watch.ended();
        let Some(fronts) = done? else {
            return Ok(FrontsAnswer::Shard { journal: path, searches });
        };
        let text = serde_json::to_string(&fronts).map_err(CompareError::Answer)? + "\n";
        let html = fronts_page(&fronts, &self.command());
        files::write_locked(&[(page.clone(), html.into_bytes()), (data, text.into_bytes())])?;
        Ok(FrontsAnswer::Whole { fronts: Box::new(fronts), folder, page })
    }

    /// The command that makes it again.
    fn command(&self) -> String {
        let mut words = vec![format!("phihat fronts {}", self.study.display())];
        words.extend(self.held_out.iter().map(|path| format!("--held-out {}", path.display())));
        words.extend((!self.only.is_empty()).then(|| format!("--only {}", self.only.join(","))));
        words.extend(self.quick.then(|| "--quick".to_owned()));
        let caps: Vec<String> = self.caps.iter().map(ToString::to_string).collect();
        words.extend((!caps.is_empty()).then(|| format!("--caps {}", caps.join(","))));
        words.extend(self.restarts.map(|n| format!("--restarts {n}")));
        words.extend(self.per_scalar.map(|n| format!("--per-scalar {n}")));
        words.extend(self.worlds.map(|[a, b, c]| format!("--worlds {a},{b},{c}")));
        words.extend(self.seed.map(|seed| format!("--seed {seed}")));
        words.extend(self.out.iter().map(|folder| format!("--out {}", folder.display())));
        words.join(" ")
    }
}

/// Takes what another journal holds over into this one; the other is left as it is.
fn take_over(journal: &mut Journal, other: &Path) -> Result<(), CompareError> {
    let path = if other.is_dir() { other.join(JOURNAL) } else { other.to_owned() };
    if !path.is_file() {
        let why = format!("{}: there is no journal of a shard here", path.display());
        return Err(CompareError::Begin(why.into()));
    }
    journal.take_over(&path)?;
    Ok(())
}
