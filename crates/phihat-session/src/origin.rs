//! Origin of a record, and the file that has its trace.

use std::path::{Path, PathBuf};

use crate::error::SessionError;
use crate::files;
use crate::layout::{BEGUN, RUN, RunOrigin, TraceKind, UNFINISHED};

/// The trace that a path stands for: of a run's folder, the one in it.
pub fn trace_at(path: &Path) -> PathBuf {
    if path.is_dir() { trace_of(path) } else { path.to_owned() }
}

/// The trace in a run's folder, of whichever kind the run left; without a record, the one that is there.
pub(crate) fn trace_of(folder: &Path) -> PathBuf {
    let named = origin(folder).ok().and_then(|RunOrigin { files, .. }| {
        // Where both are named, Parquet is of a time in which it did not have all columns.
        let mut kinds = TraceKind::ALL.into_iter().rev();
        kinds.find(|kind| files.contains_key(kind.file()))
    });
    let there = || TraceKind::ALL.into_iter().find(|kind| folder.join(kind.file()).exists());
    folder.join(named.or_else(there).unwrap_or_default().file())
}

/// Returns true if a record's folder holds the journal of a drive that was killed, or is still going on.
pub fn is_unfinished(record: &Path) -> bool {
    let folder = record.join(UNFINISHED);
    let holds = |name: &str| folder.join(name).metadata().is_ok_and(|file| file.len() > 0);
    holds(BEGUN) && holds(TraceKind::Csv.file())
}

/// Hint on making a record from this journal.
pub fn how_to_recover(record: &Path) -> String {
    format!("`phihat report --recover {}` makes its record", record.display())
}

/// Reads the origin that a record states.
pub(crate) fn origin(folder: &Path) -> Result<RunOrigin, SessionError> {
    let path = folder.join(RUN);
    if !path.is_file() {
        let why = "is missing: the files beside it are no whole record";
        let how = if is_unfinished(folder) {
            format!(
                "{why}; a drive into this folder was killed\n  = help: {}",
                how_to_recover(folder)
            )
        } else {
            format!("{why}; run the study again")
        };
        return Err(SessionError::at(&path, how));
    }
    let text = files::read(&path)?;
    serde_json::from_str(&text).map_err(|e| {
        SessionError::at(
            &path,
            format!("is not what this version leaves: {e}; run the study again"),
        )
    })
}
