//! A sweep as a user asks for it, taken to its answer; and shards of one, put together.

use std::fs;
use std::path::{Path, PathBuf};

use phihat_session::disk::{self, Whole};
use phihat_session::{SessionError, Watch, files, read_gains, threads};
use serde::{Deserialize, Serialize};

use super::error::SweepError;
use super::page::sweep_page;
use super::plan::SweepPlan;
use super::summary::{SweepResult, SweepSummary, look};
use crate::chunks::{ChunkLayout, ChunksError, RowFile, Shard, run_chunks};
use crate::folder::{JOURNAL, results_of};
use crate::journal::Journal;

/// The rows while they come, and when all are there.
const PART: &str = "runs.part";
const ROWS: &str = "runs.npy";
/// File that marks the rows of a shard as complete.
const SHARD: &str = "shard.json";
/// The last file of a sweep's results.
const ANSWER: &str = "sweep.json";

/// Options of a sweep. A shard's record stores those that all shards of a sweep have in common.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SweepOptions {
    /// The study file (TOML).
    pub study: PathBuf,
    /// A gains document in place of those that the study states or leaves to the design.
    pub gains: Option<PathBuf>,
    /// Numbers that vary, each `KEY=HOW`.
    pub vary: Vec<String>,
    /// Runs, of all shards.
    pub runs: u64,
    /// Decides what every run draws, and its seed.
    pub seed: u64,
    /// One part of all runs, `K/N`.
    #[serde(skip)]
    pub shard: Option<String>,
    /// Does every run again, whatever the journal holds.
    #[serde(skip)]
    pub fresh: bool,
    /// Runs gains even where they may not run on this arm.
    pub uncertified: bool,
    /// Runs at a time; `None`: one per core.
    #[serde(skip)]
    pub threads: Option<u16>,
    /// Folder for the results; `None`: `out/STUDY/sweep`.
    #[serde(skip)]
    pub out: Option<PathBuf>,
}

/// Result of a sweep.
#[derive(Debug)]
pub enum SweepAnswer {
    /// All of it.
    Whole(Box<SweptWhole>),
    /// A shard, whose rows are all there.
    Shard {
        /// Its folder.
        folder: PathBuf,
        /// Its runs.
        runs: u64,
    },
}

/// A whole sweep, and where it was written.
#[derive(Debug)]
pub struct SweptWhole {
    /// The answer.
    pub summary: SweepSummary,
    /// The folder of the results.
    pub folder: PathBuf,
    /// The page.
    pub page: PathBuf,
}

/// Record of a finished shard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct ShardRecord {
    plan: String,
    #[serde(flatten)]
    told: SweepOptions,
    part: u64,
    of: u64,
    runs_sha256: String,
}

impl SweepOptions {
    fn shard(&self) -> Result<Shard, SweepError> {
        let Some(text) = &self.shard else { return Ok(Shard::WHOLE) };
        Shard::parse(text).ok_or_else(|| SweepError::Shard(text.clone()))
    }

    /// Folder of the results; that of a shard is a folder of its own inside of it.
    ///
    /// # Errors
    ///
    /// [`SweepError`]: the study, whose name they take, cannot be read.
    pub fn folder(&self) -> Result<PathBuf, SweepError> {
        let studies = std::slice::from_ref(&self.study);
        let folder = results_of(studies, self.out.as_deref(), "sweep")?;
        let Shard { part, of } = self.shard()?;
        let own = format!("shard-{part}-of-{of}");
        Ok(if self.shard.is_some() { folder.join(own) } else { folder })
    }

    fn plan(&self) -> Result<SweepPlan, SweepError> {
        let gains = self.gains.as_deref().map(|file| read_gains(file).map(|g| (g, file)));
        let input = (self.study.as_path(), gains.transpose()?);
        SweepPlan::new(input, &self.vary, (self.seed, self.runs), self.uncertified)
    }

    /// Makes the plan, does the runs that its journal does not hold, and writes the answer.
    ///
    /// # Errors
    ///
    /// [`SweepError`]: an option or the study cannot be used, or a result not be written.
    pub fn run(&self, watch: &mut dyn Watch) -> Result<SweepAnswer, SweepError> {
        let shard = self.shard()?;
        let plan = self.plan()?;
        let folder = self.folder()?;
        let places = [JOURNAL, PART, ROWS, SHARD, ANSWER, "report.html", "gains.json"];
        let places = places.map(|name| folder.join(name));
        files::check_writable(&places)?;
        let [journal, part, rows, record, answer, ..] = &places;
        let mut journal = Journal::in_folder(journal, self.fresh, watch)?;
        for older in [answer, record] {
            taken_away(older)?;
        }
        if rows.exists() {
            moved(rows, part)?;
        }
        let layout = ChunkLayout::new(self.runs, shard);
        let (columns, own) = (plan.columns(), layout.own_runs());
        let head = columns.head(own);
        let mut file = RowFile::open(part, &head, columns.width(), own)?;
        watch.begun(&[]);
        let mut begun = false;
        let done = run_chunks(
            (&mut file, &mut journal),
            (&plan.id, &layout),
            threads(self.threads),
            &|runs| plan.chunk(runs),
            |done| {
                watch.progress(done, own);
                if !std::mem::replace(&mut begun, true) {
                    watch.resumed();
                }
            },
        );
        watch.ended();
        done?;
        if self.shard.is_none() {
            return leave(&plan, file, (part, &folder)).map(SweepAnswer::Whole);
        }
        let record_of = self.record(&plan, &layout, file.sha256()?);
        moved(part, rows)?;
        let gains = plan.gains.to_json().map_err(|e| SessionError::at(&self.study, e))?;
        files::write_locked(&[
            (folder.join("gains.json"), gains.into_bytes()),
            (record.clone(), document(&record_of)?),
        ])?;
        Ok(SweepAnswer::Shard { folder, runs: own })
    }

    fn record(&self, plan: &SweepPlan, layout: &ChunkLayout, runs_sha256: String) -> ShardRecord {
        ShardRecord {
            plan: plan.id.clone(),
            told: self.clone(),
            part: layout.shard.part,
            of: layout.shard.of,
            runs_sha256,
        }
    }
}

/// Merges the shards of a sweep into the results of one process, byte for byte. `folders` are those of the
/// shards, or one that contains them; the results go to `out`, else to the folder that contains the shards.
///
/// # Errors
///
/// [`SweepError`]: a shard is missing, unfinished or of another sweep; the study cannot be read any more, or
/// is another one.
pub fn merge(folders: &[PathBuf], out: Option<&Path>) -> Result<SweptWhole, SweepError> {
    let found = complete(shards(folders)?)?;
    let Some((first, record)) = found.first() else { return Err(SweepError::Nothing) };
    let plan = record.told.plan()?;
    if plan.id != record.plan {
        let why = "not the study, gains or version of phihat that the shards were made with";
        return Err(no(&record.told.study, why));
    }
    let own = || match folders {
        [one] if !one.join(SHARD).exists() => one.clone(),
        _ => first.parent().unwrap_or(Path::new("")).to_owned(),
    };
    let folder = out.map_or_else(own, Path::to_owned);
    let part = folder.join(PART);
    files::check_writable([&part, &folder.join(ANSWER)])?;
    disk::make_folder(&folder).map_err(|e| SessionError::at(&folder, e))?;
    let _held = disk::Lock::take(&folder)?;
    taken_away(&folder.join(ANSWER))?;
    let file = gathered(&plan, &found, &part)?;
    leave(&plan, file, (&part, &folder)).map(|whole| *whole)
}

/// The rows of all shards in one file.
fn gathered(plan: &SweepPlan, found: &[ShardFile], part: &Path) -> Result<RowFile, SweepError> {
    let columns = plan.columns();
    let mut file = RowFile::open(part, &columns.head(plan.runs), columns.width(), plan.runs)?;
    for (folder, record) in found {
        let shard = Shard { part: record.part, of: record.of };
        let layout = ChunkLayout::new(record.told.runs, shard);
        let head = columns.head(layout.own_runs());
        let path = folder.join(ROWS);
        let mut rows = RowFile::finished(&path, &head, columns.width(), layout.own_runs())?;
        if rows.sha256()? != record.runs_sha256 {
            return Err(no(&path, "changed since its shard was finished; run the shard again"));
        }
        for chunk in layout.chunks() {
            let runs = layout.runs_of(chunk);
            let chunk = rows.rows(layout.row_of(chunk), runs.end - runs.start)?;
            file.put(runs.start, &chunk)?;
        }
    }
    file.sync()?;
    Ok(file)
}

fn no(path: &Path, why: impl Into<String>) -> SweepError {
    SweepError::NoShard { path: path.to_owned(), why: why.into() }
}

/// All shards of one sweep, each once, in their order.
fn complete(mut found: Vec<ShardFile>) -> Result<Vec<ShardFile>, SweepError> {
    found.sort_by_key(|(_, record)| record.part);
    found.dedup_by_key(|(_, record)| (record.plan.clone(), record.part, record.of));
    let Some((first, record)) = found.first() else { return Err(SweepError::Nothing) };
    let sweep = |record: &ShardRecord| (record.plan.clone(), record.told.runs, record.of);
    let other = found.iter().find(|(_, other)| sweep(other) != sweep(record));
    if let Some((folder, _)) = other {
        return Err(no(folder, format!("of another sweep than {}", first.display())));
    }
    let of = record.of;
    let has = |part: &u64| found.iter().any(|(_, record)| record.part == *part);
    let missing: Vec<String> =
        (1..=of).filter(|part| !has(part)).map(|part| part.to_string()).collect();
    if missing.is_empty() {
        return Ok(found);
    }
    Err(SweepError::Missing { missing: missing.join(", "), count: of })
}

type ShardFile = (PathBuf, ShardRecord);

/// Every finished shard in these folders, or right below them.
fn shards(folders: &[PathBuf]) -> Result<Vec<ShardFile>, SweepError> {
    let mut found = Vec::new();
    for folder in folders {
        let mut here = vec![folder.clone()];
        if !folder.join(SHARD).exists() {
            let inside = fs::read_dir(folder);
            let inside = inside.map_err(|e| no(folder, format!("cannot be read: {e}")))?;
            here = inside.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
            here.retain(|path| path.join(SHARD).exists());
            here.sort();
        }
        if here.is_empty() {
            return Err(no(folder, "there is no finished shard of a sweep here"));
        }
        for shard in here {
            let text = files::read(&shard.join(SHARD))?;
            let record = serde_json::from_str(&text);
            let record = record.map_err(|e| SessionError::at(&shard.join(SHARD), e))?;
            found.push((shard, record));
        }
    }
    Ok(found)
}

/// Writes the answer into the folder of the rows, which are moved to their final name.
fn leave(
    plan: &SweepPlan,
    mut file: RowFile,
    (part, folder): (&Path, &Path),
) -> Result<Box<SweptWhole>, SweepError> {
    let SweepResult { summary, drawn, studies } = look(plan, &mut file)?;
    drop(file);
    moved(part, &folder.join(ROWS))?;
    let page = folder.join("report.html");
    let html = sweep_page(&summary, &drawn);
    let gains = plan.gains.to_json().map_err(|e| SessionError::at(folder, e))?;
    let mut whole = Whole::in_locked_folder();
    for older in worst_of_before(folder) {
        whole.remove(older);
    }
    whole.add(&folder.join("study.toml"), plan.study.text.as_bytes())?;
    whole.add(&folder.join("gains.json"), gains.as_bytes())?;
    for (name, text) in &studies {
        whole.add(&folder.join("worst").join(name), text.as_bytes())?;
    }
    whole.add(&page, html.as_bytes())?;
    whole.add(&folder.join(ANSWER), &document(&summary)?)?;
    whole.commit()?;
    Ok(Box::new(SweptWhole { summary, folder: folder.to_owned(), page }))
}

/// The studies of an older answer's worst runs.
fn worst_of_before(folder: &Path) -> Vec<PathBuf> {
    let inside = fs::read_dir(folder.join("worst")).into_iter().flatten();
    let mut all: Vec<PathBuf> = inside.filter_map(|entry| entry.ok().map(|e| e.path())).collect();
    all.retain(|path| path.extension().is_some_and(|kind| kind == "toml"));
    all.sort();
    all
}

fn document(value: &impl Serialize) -> Result<Vec<u8>, SweepError> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    Ok(text.into_bytes())
}

/// Takes a file of older results away, where there is one.
fn taken_away(path: &Path) -> Result<(), SweepError> {
    disk::take_away(path).map_err(|error| rows_error(path, "cannot be removed", error))
}

fn moved(from: &Path, to: &Path) -> Result<(), SweepError> {
    disk::move_to(from, to).map_err(|error| rows_error(to, "cannot be put there", error))
}

fn rows_error(path: &Path, what: &'static str, error: std::io::Error) -> SweepError {
    ChunksError::Rows { path: path.to_owned(), what, error }.into()
}
