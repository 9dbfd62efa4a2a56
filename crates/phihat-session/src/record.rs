//! A finished run, and what it leaves in its folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

use phihat_design::Gains;
use phihat_report::{Drawing, Record, RunInfo, TubeRun};
use phihat_sim::{Abort, Divergence, Metrics, ParquetTrace, Trace, TraceError, TraceWriter};
use phihat_study::Study;
use serde_json::json;

use crate::disk::{DiskError, Lock, Piece, Whole};
use crate::error::SessionError;
use crate::files;
use crate::layout::{DRIVE, GAINS, INPUTS, RUN, RunOrigin, TraceKind};
use crate::log::LogFile;
use crate::observer::figures;
use crate::page::{add_page, remove_page};

/// A finished run.
#[derive(Debug)]
pub struct Done {
    /// Study that was run.
    pub study: Box<Study>,
    /// The gains that ran; `None`: another controller did.
    pub gains: Option<Gains>,
    /// Origin of the run.
    pub run: RunInfo,
    /// The build of the program that designed them for this study, where that is known.
    pub(crate) designed_by: Option<String>,
    /// Drawing of the run.
    pub drawing: Drawing,
    /// The figures of the run.
    pub metrics: Metrics,
    /// Comparison of the run with the tube of its gains.
    pub tube: Option<TubeRun>,
    /// Set when the run diverged and was stopped.
    pub divergence: Option<Divergence>,
    /// Set when the robot's torque interface stopped the run.
    pub abort: Option<Abort>,
}

/// The trace of a run on its way to the disk.
pub(crate) struct TraceFiles {
    whole: Whole,
    /// Paths at which they are prepared.
    pub(crate) prepared: Vec<PathBuf>,
    kind: TraceKind,
    path: PathBuf,
    file: TraceFile,
    log: Option<Box<LogFile>>,
}

enum TraceFile {
    Parquet(Box<ParquetTrace<Piece>>),
    Csv(Box<TraceWriter<Piece>>),
}

impl TraceFiles {
    pub(crate) fn begin(folder: &Path, kind: TraceKind) -> Result<Self, DiskError> {
        let mut whole = Whole::in_locked_folder();
        let path = folder.join(kind.file());
        let piece = whole.begin(&path)?;
        let prepared = vec![piece.prepared_at().to_owned()];
        let file = match kind {
            TraceKind::Parquet => TraceFile::Parquet(Box::new(ParquetTrace::new(piece))),
            TraceKind::Csv => TraceFile::Csv(Box::new(TraceWriter::new(piece))),
        };
        Ok(Self { whole, prepared, kind, path, file, log: None })
    }

    /// The same with a log beside the record.
    pub(crate) fn logged(
        mut self,
        log: &Path,
        study: &Study,
        gains: &Gains,
    ) -> Result<Self, SessionError> {
        let log = LogFile::begin(log, study, gains)?;
        self.prepared.push(log.prepared_at().to_owned());
        self.log = Some(Box::new(log));
        Ok(self)
    }

    pub(crate) fn block(&mut self, trace: &Trace) -> Result<(), DiskError> {
        let told = |why: TraceError| DiskError::untouched(&self.path, why);
        match &mut self.file {
            TraceFile::Parquet(file) => file.block(trace).map_err(TraceError::from),
            TraceFile::Csv(file) => file.block(trace),
        }
        .map_err(told)?;
        self.log.iter_mut().try_for_each(|log| log.block(trace))
    }

    /// The files, ready to be moved in, and the SHA-256 of each by its name.
    fn end(self) -> Result<(Whole, BTreeMap<String, String>), DiskError> {
        if let Some(log) = self.log {
            log.end()?;
        }
        let piece = match self.file {
            TraceFile::Parquet(file) => file.finish().map_err(TraceError::from),
            TraceFile::Csv(file) => file.finish(),
        };
        let piece = piece.map_err(|why| DiskError::untouched(&self.path, why))?;
        let mut whole = self.whole;
        let sum = whole.end(piece)?;
        // One of another kind that an older run left would stand beside a trace that is not its own.
        for other in TraceKind::ALL.into_iter().filter(|kind| *kind != self.kind) {
            whole.remove(self.path.with_file_name(other.file()));
        }
        Ok((whole, BTreeMap::from([(self.kind.file().to_owned(), sum)])))
    }
}

impl Done {
    /// The record that a report is made from.
    pub fn record(&self) -> Record<'_> {
        Record {
            run: &self.run,
            study_text: &self.study.text,
            gains: self.gains.as_ref(),
            drawing: &self.drawing,
            metrics: &self.metrics,
            tube: self.tube.as_ref(),
        }
    }

    /// Writes trace, metrics, gains, origin and study into a folder: a whole record in place of an older one,
    /// whose page is removed.
    ///
    /// # Errors
    ///
    /// [`SessionError`], naming the file that cannot be written, or that another process is at work there.
    pub fn write(&self, trace: &Trace, folder: &Path, kind: TraceKind) -> Result<(), SessionError> {
        let _held = Lock::take(folder)?;
        let mut files = TraceFiles::begin(folder, kind)?;
        files.block(trace)?;
        self.leave(files, folder, None, None)
    }

    /// Writes the record into a folder that is locked, with a page, the trace being on its way; `drive` is
    /// the document of its drive.
    pub(crate) fn leave(
        &self,
        trace: TraceFiles,
        folder: &Path,
        page: Option<&Path>,
        drive: Option<&serde_json::Value>,
    ) -> Result<(), SessionError> {
        let at = |name: &str| folder.join(name);
        let pretty = |value: &serde_json::Value| format!("{value:#}\n").into_bytes();
        let (mut whole, mut files) = trace.end()?;
        let gains = self.gains.as_ref().map(Gains::to_json).transpose()?;
        let own = [
            ("study.toml", Some(self.study.text.clone().into_bytes())),
            (GAINS, gains.map(String::into_bytes)),
            ("metrics.json", Some(pretty(&self.figures()))),
            (DRIVE, drive.map(pretty)),
        ];
        for (name, bytes) in own {
            let Some(bytes) = bytes else {
                whole.remove(at(name));
                continue;
            };
            let sum = whole.add(&at(name), &bytes)?;
            files.insert(name.to_owned(), sum);
        }
        let inputs = at(INPUTS);
        for older in files_below(&inputs) {
            whole.remove(older);
        }
        files.extend(add_inputs(&mut whole, &inputs, &self.study)?);
        match page {
            Some(page) => add_page(&mut whole, &self.record(), page)?,
            None => remove_page(&mut whole, &at("report.html")),
        }
        let (run, designed_by) = (self.run.clone(), self.designed_by.clone());
        let origin = RunOrigin { run, designed_by, files };
        whole.add(&at(RUN), &pretty(&json!(origin)))?;
        Ok(whole.commit()?)
    }

    /// The figures of the run: its metrics, and under `tube` the run beside the tube that its gains carry.
    pub fn figures(&self) -> serde_json::Value {
        figures(&self.metrics, self.tube.as_ref())
    }

    /// Returns true if the run came to its end, satisfied every bound, and broke no claim of its tube.
    pub fn good(&self) -> bool {
        let ended = self.divergence.is_none() && self.abort.is_none();
        ended
            && self.metrics.within_spec
            && self.tube.as_ref().is_none_or(|run| run.broken().is_none())
    }

    /// The verdict as one word.
    pub fn verdict(&self) -> &'static str {
        if self.tube.as_ref().is_some_and(|run| run.broken().is_some()) {
            "certificate_broken"
        } else if self.divergence.is_some() {
            "diverged"
        } else if self.abort.is_some() {
            "stopped"
        } else if !self.metrics.within_spec {
            "outside_spec"
        } else if self.metrics.limited_steady_share > 0.0 {
            "within_spec_limited"
        } else {
            "within_spec"
        }
    }
}

/// Prepares the files that a study names in a folder; the SHA-256 of each by its name in the record.
pub(crate) fn add_inputs(
    whole: &mut Whole,
    folder: &Path,
    study: &Study,
) -> Result<BTreeMap<String, String>, SessionError> {
    let mut sums = BTreeMap::new();
    for (name, path) in &study.inputs {
        let mut input = files::open(path)?;
        let sum = whole.add_with(&folder.join(name), |file| io::copy(&mut input, file).map(drop));
        sums.insert(Path::new(INPUTS).join(name).display().to_string(), sum?);
    }
    Ok(sums)
}

/// Files of a folder and those below it; none where it cannot be read.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let below = |path: PathBuf| if path.is_dir() { files_below(&path) } else { vec![path] };
    entries.flat_map(|entry| below(entry.path())).collect()
}
