//! The journal of a campaign: one line per finished run, appended and never changed.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use thiserror::Error;

use phihat_session::disk::{self, Operation, strike, sync_folder};
use phihat_session::{Watch, short_hash};

/// An append-only file of JSON lines, each with a checksum, open for one process at a time.
///
/// A line is `{"id":…,"sum":…,"entry":…}`; `sum` is the head of the SHA-256 of id and entry. What a crash
/// left half-written fails its checksum and is passed over, so that its run is simply done again.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    entries: BTreeMap<String, String>,
    damaged: Vec<usize>,
}

/// Why a journal cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum JournalError {
    /// Reading, writing or locking failed.
    #[error("{}: {what}: {error}", path.display())]
    Io {
        /// The journal.
        path: PathBuf,
        /// Description of the failed operation.
        what: &'static str,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// Another process writes to it.
    #[error("{}: another campaign writes to this journal; wait for it, or choose another folder", .0.display())]
    Busy(PathBuf),
    /// An entry cannot be written as JSON.
    #[error("the entry of run {id} cannot be written: {error}")]
    Entry {
        /// The run.
        id: String,
        /// Why.
        error: serde_json::Error,
    },
}

/// Largest number of damaged lines that are listed by number.
const SHOWN: usize = 10;

#[derive(Serialize)]
struct JournalLine<'a> {
    id: &'a str,
    sum: String,
    entry: &'a RawValue,
}

#[derive(Deserialize)]
struct EntryOfId {
    id: String,
    sum: String,
    entry: Box<RawValue>,
}

impl Journal {
    /// Opens a journal, or begins one, and reads what it holds.
    ///
    /// # Errors
    ///
    /// [`JournalError`]: the file cannot be read or written, or another process has it open.
    pub fn open(path: &Path) -> Result<Self, JournalError> {
        Self::read(path, Self::locked(path)?)
    }

    /// Opens the journal of a campaign, or begins one, in a folder that is created if it is missing; reports
    /// the lines that cannot be used. No other process writes to its folder while it is open.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open), and where the folder cannot be made.
    pub fn in_folder(
        path: &Path,
        fresh: bool,
        watch: &mut dyn Watch,
    ) -> Result<Self, JournalError> {
        let folder = disk::folder_of(path);
        disk::make_folder(folder).map_err(|error| io(folder, "cannot be made", error))?;
        let journal = if fresh { Self::afresh(path) } else { Self::open(path) }?;
        watch.saved_in(path);
        if let Some(damage) = journal.damage() {
            watch.warn(&format!("{}: {damage}", path.display()));
        }
        Ok(journal)
    }

    /// Opens a journal, or begins one, emptied of what it held. One that another process has open is left as it is.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    pub fn afresh(path: &Path) -> Result<Self, JournalError> {
        let file = Self::locked(path)?;
        strike(Operation::Write, path)
            .and_then(|()| file.set_len(0))
            .and_then(|()| file.sync_all())
            .map_err(|error| io(path, "cannot be emptied", error))?;
        Self::read(path, file)
    }

    fn locked(path: &Path) -> Result<File, JournalError> {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let file = strike(Operation::Open, path)
            .and_then(|()| options.open(path))
            .map_err(|error| io(path, "cannot be opened", error))?;
        if disk::locked(&file, path).map_err(|error| io(path, "cannot be locked", error))? {
            return Ok(file);
        }
        Err(JournalError::Busy(path.to_owned()))
    }

    /// Reads what a locked journal holds; what comes goes behind it.
    fn read(path: &Path, mut file: File) -> Result<Self, JournalError> {
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(|error| io(path, "cannot be read", error))?;
        if bytes.is_empty() {
            sync_folder(disk::folder_of(path))
                .map_err(|error| io(path, "cannot be written", error))?;
        }
        let mut journal =
            Self { path: path.to_owned(), file, entries: BTreeMap::new(), damaged: Vec::new() };
        let lines = (1..).zip(bytes.split(|&byte| byte == b'\n'));
        for (number, line) in lines.filter(|(_, line)| !line.is_empty()) {
            match read_line(line) {
                Some((id, entry)) => _ = journal.entries.insert(id, entry),
                None => journal.damaged.push(number),
            }
        }
        if bytes.last().is_some_and(|&byte| byte != b'\n') {
            // What a crash cut off must not swallow the next line.
            journal.write(b"\n")?;
        }
        Ok(journal)
    }

    /// Entry of a run, as the JSON text that was written; `None` if the run is not recorded.
    pub fn entry(&self, id: &str) -> Option<&str> {
        self.entries.get(id).map(String::as_str)
    }

    /// Numbers, from 1, of the lines that were no record when the journal was opened: no JSON, or a wrong
    /// checksum.
    pub fn damaged(&self) -> &[usize] {
        &self.damaged
    }

    /// Message with the numbers of the damaged lines; `None` if no line is damaged.
    pub fn damage(&self) -> Option<String> {
        let shown: Vec<_> = self.damaged.iter().take(SHOWN).map(ToString::to_string).collect();
        let shown = shown.join(", ");
        match self.damaged.len() {
            0 => None,
            1 => Some(format!(
                "line {shown} is damaged and passed over; its run is done again if it is asked for"
            )),
            all => {
                let more =
                    if all > SHOWN { format!(" and {} more", all - SHOWN) } else { String::new() };
                Some(format!(
                    "lines {shown}{more} are damaged and passed over; their runs are done again if they are asked for"
                ))
            }
        }
    }

    /// Number of recorded runs.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns true if no run is recorded.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Records a run; it is on the disk when this returns.
    ///
    /// # Errors
    ///
    /// [`JournalError`]: the entry is no JSON, or the disk does not take it.
    pub fn append(&mut self, id: &str, entry: &impl Serialize) -> Result<(), JournalError> {
        self.append_all([(id, entry)])
    }

    /// Records several runs at once: the disk is waited for once.
    ///
    /// # Errors
    ///
    /// As [`append`](Self::append); then none of them counts as recorded.
    pub fn append_all<'a, E: Serialize + 'a>(
        &mut self,
        runs: impl IntoIterator<Item = (&'a str, &'a E)>,
    ) -> Result<(), JournalError> {
        let (mut lines, mut entries) = (Vec::new(), Vec::new());
        for (id, entry) in runs {
            let refuse = |error| JournalError::Entry { id: id.to_owned(), error };
            let entry = serde_json::value::to_raw_value(entry).map_err(refuse)?;
            let line = JournalLine { id, sum: sum(id, entry.get()), entry: &entry };
            serde_json::to_writer(&mut lines, &line).map_err(refuse)?;
            lines.push(b'\n');
            entries.push((id.to_owned(), entry.get().to_owned()));
        }
        self.write(&lines)?;
        self.entries.extend(entries);
        Ok(())
    }

    /// Records the runs that another journal, such as that of a shard, has and this one has not. The other
    /// journal is not changed; its damaged lines are skipped. Returns the number of new runs.
    ///
    /// # Errors
    ///
    /// [`JournalError`]: the other cannot be read, or the disk does not take it.
    pub fn take_over(&mut self, other: &Path) -> Result<usize, JournalError> {
        let bytes = std::fs::read(other).map_err(|error| io(other, "cannot be read", error))?;
        let found = bytes.split(|&byte| byte == b'\n').filter_map(read_line);
        let mut new: BTreeMap<String, Box<RawValue>> = BTreeMap::new();
        for (id, entry) in found.filter(|(id, _)| !self.entries.contains_key(id)) {
            let entry = RawValue::from_string(entry);
            let entry = entry.map_err(|error| JournalError::Entry { id: id.clone(), error })?;
            new.insert(id, entry);
        }
        self.append_all(new.iter().map(|(id, entry)| (id.as_str(), entry)))?;
        Ok(new.len())
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), JournalError> {
        let written = disk::write_all(&mut self.file, &self.path, bytes)
            .and_then(|()| strike(Operation::Sync, &self.path))
            .and_then(|()| self.file.sync_data());
        written.map_err(|error| io(&self.path, "cannot be written", error))
    }
}

fn io(path: &Path, what: &'static str, error: std::io::Error) -> JournalError {
    JournalError::Io { path: path.to_owned(), what, error }
}

/// Id and entry of a line, if its checksum is right.
fn read_line(line: &[u8]) -> Option<(String, String)> {
    let found: EntryOfId = serde_json::from_slice(line).ok()?;
    let right = sum(&found.id, found.entry.get()) == found.sum;
    right.then(|| (found.id, found.entry.get().to_owned()))
}

fn sum(id: &str, entry: &str) -> String {
    let mut sum = short_hash(&[id, entry]);
    sum.truncate(8);
    sum
}
