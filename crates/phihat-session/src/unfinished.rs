//! Journal of a drive while it goes on, and the recovery of a record from it if the process is killed.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufRead, BufReader, BufWriter, Read as _};
use std::path::{Path, PathBuf};

use phihat_design::Gains;
use phihat_report::RunInfo;
use phihat_sim::{BLOCK, Trace, TraceWriter};
use phihat_study::Study;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::disk::{DiskError, Growing, Lock, Whole, take_away, take_folder_away};
use crate::error::SessionError;
use crate::files;
use crate::layout::{BEGUN, GAINS, INPUTS, RunOrigin, TraceKind, UNFINISHED};
use crate::observer::{RunFigures, RunObserver, error_shares, share_entries};
use crate::origin::{how_to_recover, is_unfinished};
use crate::record::{Done, TraceFiles, add_inputs};
use crate::run_record::{belongs, study_and_gains};

/// Largest part of a drive that is lost if the process is killed \[s\].
pub const LOST_MAX_S: f64 = 1.0;

/// Content of `begun.json`: that of `run.json` and `drive.json`, as far as it was known when the drive began.
#[derive(Serialize, Deserialize)]
struct UnfinishedHead {
    #[serde(flatten)]
    origin: RunOrigin,
    /// The file that the trace of the record is to be in.
    trace: String,
    drive: Map<String, Value>,
}

/// A folder with study, gains, inputs and a trace (CSV) that grows with every part of a drive. It stands in
/// the folder of the record until that is whole.
pub(crate) struct DriveJournal {
    folder: PathBuf,
    csv: TraceWriter<BufWriter<Growing>>,
    /// True if it holds a sample.
    any: bool,
}

/// Bytes that are written at once.
const BUFFER: usize = 1 << 18;

impl DriveJournal {
    /// In a record's folder that is locked.
    pub(crate) fn begin(
        record: &Path,
        (study, gains): (&Study, &Gains),
        run: RunInfo,
        (kind, drive): (TraceKind, Map<String, Value>),
    ) -> Result<Self, SessionError> {
        if is_unfinished(record) {
            return Err(left_behind(record));
        }
        let folder = record.join(UNFINISHED);
        let told = |why: io::Error| DiskError::untouched(&folder, why);
        // Of a drive that ended before its first sample was there, or whose record is whole.
        if let Some(name) = not_ours(&folder) {
            let why = format!("{name} is there, which no drive leaves: put it elsewhere");
            return Err(SessionError::at(&folder, why));
        }
        take_folder_away(&folder).map_err(told)?;
        let mut whole = Whole::in_locked_folder();
        let mut origin = RunOrigin { run, designed_by: None, files: BTreeMap::new() };
        let gains = gains.to_json()?;
        for (name, text) in [("study.toml", study.text.as_bytes()), (GAINS, gains.as_bytes())] {
            origin.files.insert(name.to_owned(), whole.add(&folder.join(name), text)?);
        }
        origin.files.extend(add_inputs(&mut whole, &folder.join(INPUTS), study)?);
        let begun = UnfinishedHead { origin, trace: kind.file().to_owned(), drive };
        let text = serde_json::to_string_pretty(&begun).map_err(SessionError::other)?;
        whole.add(&folder.join(BEGUN), text.as_bytes())?;
        whole.commit()?;
        let path = folder.join(TraceKind::Csv.file());
        let file = Growing::new(&path).map_err(|why| DiskError::untouched(&path, why))?;
        let csv = TraceWriter::new(BufWriter::with_capacity(BUFFER, file));
        Ok(Self { folder, csv, any: false })
    }

    /// Keeps the next samples: whatever ends the process after this, they can be read back.
    pub(crate) fn keep(&mut self, part: &Trace) -> Result<(), SessionError> {
        let kept = self.csv.block(part).and_then(|()| self.csv.flush());
        self.any |= kept.is_ok();
        Ok(kept.map_err(|why| DiskError::untouched(&self.folder, why))?)
    }

    /// The record is whole, or nothing was driven: it goes.
    pub(crate) fn remove(self) -> Result<(), SessionError> {
        let Self { folder, csv, .. } = self;
        drop(csv);
        removed(&folder)
    }

    /// There will be no record: it goes if it holds nothing, else how to make one of it is told.
    pub(crate) fn abandon(self) -> Option<String> {
        if self.any {
            let record = self.folder.parent().unwrap_or(&self.folder);
            return Some(format!("what was driven is kept: {}", how_to_recover(record)));
        }
        // Whoever drives there next takes away what is left.
        let _ = self.remove();
        None
    }
}

/// The name of something in an unfinished record that is not of one.
fn not_ours(folder: &Path) -> Option<String> {
    let ours = ["study.toml", GAINS, INPUTS, BEGUN, TraceKind::Csv.file()];
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let mut names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.find(|name| !ours.contains(&name.as_str()) && !name.ends_with(".partial"))
}

/// Takes an unfinished record away, first what says that it is one.
fn removed(folder: &Path) -> Result<(), SessionError> {
    let told = |why: io::Error| SessionError::at(folder, format!("cannot be removed: {why}"));
    take_away(&folder.join(BEGUN)).and_then(|()| take_folder_away(folder)).map_err(told)
}

/// That nothing is driven over what is left of another drive.
fn left_behind(record: &Path) -> SessionError {
    let how = how_to_recover(record);
    let why = format!(
        "is what is left of a drive that was killed, and is not driven over\n  = help: {how}; or choose another folder \
            by --out; or remove it"
    );
    SessionError::at(&record.join(UNFINISHED), why)
}

/// Checks that a drive may leave its record in a folder: that there is no journal of one that was killed.
///
/// # Errors
///
/// [`SessionError`]: there is, or another process is at work there.
pub fn none_unfinished(record: &Path) -> Result<(), SessionError> {
    if !is_unfinished(record) {
        return Ok(());
    }
    let _held = Lock::take(record)?;
    Err(left_behind(record))
}

/// Recovered part of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recovered {
    /// Number of samples.
    pub samples: u64,
    /// End of the samples \[s\]: the process was killed then, or up to [`LOST_MAX_S`] later.
    pub until_s: f64,
}

/// Makes a record of what is left of a drive that was killed, in place of an older record in its folder;
/// without a page.
///
/// # Errors
///
/// [`SessionError`]: there is nothing of the kind, its files are not those that the drive left, or the record
/// cannot be written; then what is left stays.
pub fn recover(record: &Path) -> Result<Recovered, SessionError> {
    if !is_unfinished(record) {
        let why = "nothing is left here of a drive that was killed: there is nothing to recover";
        return Err(SessionError::at(record, why));
    }
    let _held = Lock::take(record)?;
    let folder = record.join(UNFINISHED);
    let begun = folder.join(BEGUN);
    let UnfinishedHead { origin, trace, mut drive } = serde_json::from_str(&files::read(&begun)?)
        .map_err(|e| {
        SessionError::at(&begun, format!("is not what this version leaves: {e}"))
    })?;
    for (name, sum) in &origin.files {
        belongs(&folder.join(name), Some(sum), "no record can be made without it")?;
    }
    let (study, gains) = study_and_gains(&folder, &origin)?;
    let kind = TraceKind::ALL.into_iter().find(|kind| kind.file() == trace).unwrap_or_default();
    let mut files = TraceFiles::begin(record, kind)?;
    let mut seen = RunObserver::new(&study, gains.as_ref());
    let mut shares = gains.as_ref().and_then(|gains| error_shares(&study, gains));
    let (mut samples, mut end_ns) = (0, 0);
    let path = folder.join(TraceKind::Csv.file());
    for_each_whole(&path, &study, |block| {
        samples += block.len() as u64;
        end_ns = block.t_ns.last().copied().unwrap_or_default();
        if let Some(shares) = &mut shares {
            shares.fill(block);
        }
        seen.block(block);
        files.block(block)
    })?;
    let until_s = (end_ns + study.control.period_ns) as f64 * 1e-9;
    let RunFigures { metrics, drawing, tube } = seen.finish(&study.sha256);
    let mut run = origin.run;
    run.warnings.push(format!(
        "KILLED: the process that drove was killed at t = {until_s:.3} s or up to {LOST_MAX_S:.0} s later; the record \
            ends there"
    ));
    let on = drive.get("on").and_then(Value::as_str);
    run.world.extend(on.map(|on| ("driven".to_owned(), on.to_owned())));
    drive.insert("end".to_owned(), "killed".into());
    drive.insert("samples".to_owned(), samples.into());
    drive.extend(shares.iter().flat_map(share_entries));
    let drive = Value::Object(drive);
    let (designed_by, divergence, abort) = (None, None, None);
    let done = Done { study, gains, run, designed_by, drawing, metrics, tube, divergence, abort };
    done.leave(files, record, None, Some(&drive))?;
    removed(&folder)?;
    Ok(Recovered { samples, until_s })
}

/// Hands over the samples of a trace that a kill may have cut off anywhere, in blocks: all that are whole.
fn for_each_whole(
    path: &Path,
    study: &Study,
    mut each: impl FnMut(&mut Trace) -> Result<(), DiskError>,
) -> Result<(), SessionError> {
    let bytes = whole_part(BufReader::new(files::open(path)?), study.robot.joints.len());
    let bytes = bytes.map_err(|why| SessionError::at(path, format!("cannot be read: {why}")))?;
    let mut taken = Ok(());
    Trace::read_csv_in(files::open(path)?.take(bytes), study, BLOCK, |block| {
        if taken.is_ok() {
            taken = each(block);
        }
    })
    .map_err(|why| SessionError::at(path, why))?;
    Ok(taken?)
}

/// Bytes up to the end of the last sample that is whole: a header, and a line per joint.
fn whole_part(mut file: impl BufRead, joints: usize) -> io::Result<u64> {
    let (mut at, mut whole, mut lines) = (0, 0, 0);
    loop {
        let part = file.fill_buf()?;
        let length = part.len();
        if length == 0 {
            return Ok(whole);
        }
        for (i, _) in part.iter().enumerate().filter(|(_, byte)| **byte == b'\n') {
            if lines % joints.max(1) == 0 {
                whole = at + i as u64 + 1;
            }
            lines += 1;
        }
        at += length as u64;
        file.consume(length);
    }
}

#[cfg(test)]
mod tests {
    use super::whole_part;

    /// Against the lines counted by hand.
    #[test]
    fn a_sample_is_whole_with_its_last_joints_line() {
        let text = "head\n0 a\n0 b\n1 a\n1 b\n2 a\n";
        for end in 0..=text.len() {
            let cut = &text[..end];
            let lines = cut.matches('\n').count();
            let kept = if lines == 0 { 0 } else { lines - (lines - 1) % 2 };
            let expected: usize = text.split_inclusive('\n').take(kept).map(str::len).sum();
            let found = whole_part(std::io::BufReader::with_capacity(3, cut.as_bytes()), 2);
            assert_eq!(found.unwrap(), expected as u64, "{cut:?}");
        }
    }
}
