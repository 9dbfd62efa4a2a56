//! The record of an earlier run, read back: its files are of one run, or it is refused.

use std::path::{Component, Path};

use crate::disk::{Lock, folder_of};
use crate::hash::sha256;
use phihat_design::Gains;
use phihat_report::{Record, RunInfo};
use phihat_sim::{BLOCK, Trace};
use phihat_study::Study;

use crate::error::SessionError;
use crate::files;
use crate::layout::{FILES, GAINS, INPUTS, OUTSIDE, RUN, RunOrigin, TraceKind};
use crate::observer::{RunFigures, RunObserver, figures, settle};
use crate::origin::{is_unfinished, origin, trace_of};
use crate::page::write_page;
use crate::record::Done;
use crate::renamed;

/// A record whose files belong together.
#[derive(Debug)]
pub struct RunRecord {
    /// Origin of the run.
    pub run: RunInfo,
    /// Study that was run.
    pub study: Box<Study>,
    /// The gains that ran; `None`: another controller did.
    pub gains: Option<Gains>,
    /// Figures of its trace.
    pub seen: RunFigures,
    /// The build of the program that designed the gains for this study, where that is known.
    designed_by: Option<String>,
}

impl RunRecord {
    /// The record that a page is made from.
    pub fn record(&self) -> Record<'_> {
        Record {
            run: &self.run,
            study_text: &self.study.text,
            gains: self.gains.as_ref(),
            drawing: &self.seen.drawing,
            metrics: &self.seen.metrics,
            tube: self.seen.tube.as_ref(),
        }
    }

    /// Checks that a file can be the trace of a record: that it exists, and its name.
    pub(crate) fn is_named(trace: &Path) -> Result<(), SessionError> {
        files::open(trace)?;
        if TraceKind::ALL.iter().any(|kind| trace.ends_with(kind.file())) {
            return Ok(());
        }
        Err(SessionError::at(
            trace,
            "is not the trace of a run; `phihat run` leaves a trace.parquet, or with --csv a trace.csv, beside its \
                run.json",
        ))
    }

    /// Reads the record that a trace is of.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: a file is missing, or is not the one that the run left.
    pub fn read(trace: &Path) -> Result<Self, SessionError> {
        Self::read_in(trace, BLOCK, |_| ())
    }

    /// Reads the record of a trace, and passes the trace on in blocks of at most so many samples; they are
    /// valid only if this does not fail.
    fn read_in(
        trace: &Path,
        block: usize,
        mut each: impl FnMut(&mut Trace),
    ) -> Result<Self, SessionError> {
        let folder = folder_of(trace);
        let whole = origin(folder)?;
        let RunOrigin { run, files, .. } = &whole;
        let again = format!("make the record again: {}", run.command);
        let own = trace.file_name().and_then(|name| name.to_str());
        let more = files.keys().map(String::as_str);
        let more = more.filter(|name| !FILES.contains(name) && Some(*name) != own);
        let ours = (run.form != OUTSIDE && !files.contains_key(GAINS)).then_some(GAINS);
        for name in FILES.iter().copied().chain(own).chain(ours).chain(more) {
            if !inside(Path::new(name)) {
                let why = format!("names {name:?}, which is no file of a record");
                return Err(SessionError::at(&folder.join(RUN), why));
            }
            belongs(&folder.join(name), files.get(name).map(String::as_str), &again)?;
        }
        let (study, gains) = study_and_gains(folder, &whole)?;
        let RunOrigin { run, designed_by, .. } = whole;
        let mut seen = RunObserver::new(&study, gains.as_ref());
        Trace::read_in(files::open(trace)?, &study, block, |block| {
            seen.block(block);
            each(block);
        })
        .map_err(|e| SessionError::at(trace, e))?;
        let seen = seen.finish(&study.sha256);
        Ok(Self { run, study, gains, seen, designed_by })
    }

    /// Checks that the figures of the record are those of its trace.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: they are not, or cannot be read.
    pub(crate) fn figures_hold(&self, folder: &Path) -> Result<(), SessionError> {
        let path = folder.join("metrics.json");
        let mut stated: serde_json::Value =
            serde_json::from_str(&files::read(&path)?).map_err(|e| SessionError::at(&path, e))?;
        renamed::rename(&mut stated);
        let mut found = figures(&self.seen.metrics, self.seen.tube.as_ref());
        // Records of before say nothing of the tip.
        if let (None, Some(figures)) = (stated.get("tip"), found.as_object_mut()) {
            figures.remove("tip");
        }
        if stated == found {
            return Ok(());
        }
        Err(SessionError::at(&path, "does not say what follows from the trace"))
    }
}

/// The study and the gains that lie in a folder, as they ran.
pub(crate) fn study_and_gains(
    folder: &Path,
    RunOrigin { run, files, .. }: &RunOrigin,
) -> Result<(Box<Study>, Option<Gains>), SessionError> {
    let text = files::read(&folder.join("study.toml"))?;
    let origin = folder.join("study.toml").display().to_string();
    let study = Study::from_record(&text, &origin, &folder.join(INPUTS)).map(Box::new);
    let mut study = study?;
    phihat_sim::derive_substeps(&mut study);
    let gains = files.contains_key(GAINS).then(|| folder.join(GAINS));
    let gains = gains.as_deref().map(files::read_gains).transpose()?;
    // A study is called as its file was when it ran.
    study.name.clone_from(&run.study);
    if let Some(gains) = &gains {
        settle(&mut study, gains);
    }
    Ok((study, gains))
}

/// Reads the record of a run, as `phihat run` leaves it, with every signal of every joint.
///
/// # Errors
///
/// [`SessionError`]: a file is missing, or is not the one that the run left.
pub fn recorded(folder: &Path) -> Result<(Done, Trace), SessionError> {
    let mut whole = Trace::default();
    let kept =
        RunRecord::read_in(&trace_of(folder), usize::MAX, |block| whole = std::mem::take(block))?;
    let RunRecord { run, study, gains, seen, designed_by } = kept;
    let RunFigures { metrics, drawing, tube } = seen;
    let (divergence, abort) = (None, None);
    let done = Done { study, gains, run, designed_by, drawing, metrics, tube, divergence, abort };
    Ok((done, whole))
}

/// The gains that `program` designed for this very study, from the record in a folder; `None`: there are
/// none, or a file has changed: the study, one that it names, or the gains.
pub(crate) fn designed_before(study: &Study, folder: &Path, program: &str) -> Option<Gains> {
    let RunOrigin { run, designed_by, files } = origin(folder).ok()?;
    if run.study != study.name || designed_by.as_deref() != Some(program) {
        return None;
    }
    let is = |name: &str, path: &Path| {
        belongs(path, files.get(name).map(String::as_str), &run.command).is_ok()
    };
    let input = |name: &Path| Path::new(INPUTS).join(name).display().to_string();
    let mut inputs = study.inputs.iter();
    let recorded = files.keys().filter(|name| Path::new(name).starts_with(INPUTS)).count();
    let gains = folder.join(GAINS);
    let same = files.get("study.toml") == Some(&study.sha256)
        && study.inputs.len() == recorded
        && inputs.all(|(name, path)| is(&input(name.as_ref()), path))
        && is(GAINS, &gains);
    if !same {
        return None;
    }
    Gains::from_json(&files::read(&gains).ok()?).ok()
}

/// Makes the page of a record again, from its files alone; says what the record is.
///
/// # Errors
///
/// [`SessionError`]: the files are not of one run, or the page cannot be written.
pub fn report_again(trace: &Path, page: &Path) -> Result<RunRecord, SessionError> {
    let folder = folder_of(trace);
    if is_unfinished(folder) {
        // Of a drive that was killed over no older record there is no trace to be found.
        origin(folder)?;
    }
    RunRecord::is_named(trace)?;
    // Nobody may put another run there between reading it and writing its page.
    let beside = folder_of(page) == folder;
    let held =
        if beside { Some(Lock::take(folder)?) } else { Lock::take_if_used(folder_of(page))? };
    let kept = RunRecord::read(trace)?;
    write_page(&kept.record(), page, held.as_ref())?;
    Ok(kept)
}

/// Returns true if gains that are to be written to a file would replace different gains of a run.
pub fn are_of_a_run(gains: &Path, text: &str) -> bool {
    let Ok(RunOrigin { files, .. }) = origin(folder_of(gains)) else { return false };
    let named = gains.file_name().and_then(|name| files.get(name.to_str()?));
    named.is_some_and(|sum| sha256(&mut text.as_bytes()).is_ok_and(|new| new != *sum))
}

/// Returns true if a name is that of a file in the record's folder, or below it.
fn inside(name: &Path) -> bool {
    name.components().all(|part| matches!(part, Component::Normal(_)))
}

/// Checks that a file is the one that the run left.
pub(crate) fn belongs(
    path: &Path,
    expected: Option<&str>,
    again: &str,
) -> Result<(), SessionError> {
    let refuse = |why: String| Err(SessionError::at(path, format!("{why}\n  = help: {again}")));
    let Some(expected) = expected else { return refuse(format!("is not named in {RUN}")) };
    if !path.is_file() {
        return refuse("is missing: the run left it".to_owned());
    }
    let found = sha256(&mut files::open(path)?).map_err(|e| SessionError::at(path, e))?;
    if found == expected {
        return Ok(());
    }
    refuse(format!(
        "is not the file that the run left: its SHA-256 is {found}, and {RUN} says {expected}"
    ))
}
