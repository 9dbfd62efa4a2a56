//! Runs by the million: rows of fixed width on the disk, done in chunks, with one line of a journal per chunk.
//!
//! Memory holds only a few chunks. The position of each row is known in advance, so that no rows are sorted
//! or collected in memory. A chunk is complete when its rows, and after them its checksum in the journal, are
//! on the disk: after an interruption, every chunk that does not agree with the journal is computed again.

use std::fs::File;
use std::io::{BufReader, Read as _, Seek as _, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;

use phihat_session::disk::{self, Operation, strike};
use phihat_session::sha256;
use thiserror::Error;

use crate::journal::{Journal, JournalError};
use crate::runner::group;

/// Largest chunk \[runs\].
const CHUNK_MAX: u64 = 256;

/// One part of all runs: part `part` of `of`, numbered from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of the part, from 1.
    pub part: u64,
    /// Number of parts.
    pub of: u64,
}

impl Shard {
    /// All runs.
    pub const WHOLE: Self = Self { part: 1, of: 1 };

    /// From `K/N`, 1 ≤ K ≤ N ≤ 100000; `None` of anything else.
    pub fn parse(text: &str) -> Option<Self> {
        let (part, of) = text.split_once('/')?;
        let shard = Self { part: part.trim().parse().ok()?, of: of.trim().parse().ok()? };
        (1..=100_000).contains(&shard.of).then_some(())?;
        (1..=shard.of).contains(&shard.part).then_some(shard)
    }
}

/// Division of the runs into chunks, and of the chunks among shards. No result depends on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChunkLayout {
    /// All runs, of all shards.
    pub runs: u64,
    /// Runs of a chunk; the last one may have fewer.
    pub chunk: u64,
    /// Every `of`-th chunk is this shard's.
    pub shard: Shard,
}

impl ChunkLayout {
    /// Of so many runs: a thousand chunks or so, of eight runs at least where there are enough.
    pub fn new(runs: u64, shard: Shard) -> Self {
        let chunk =
            if runs < 64 { 1 } else { (runs / 1024).next_multiple_of(8).clamp(8, CHUNK_MAX) };
        Self { runs, chunk, shard }
    }

    /// The chunks of this shard.
    pub fn chunks(&self) -> impl Iterator<Item = u64> + use<> {
        let (first, step) =
            (self.shard.part - 1, usize::try_from(self.shard.of).unwrap_or(usize::MAX));
        (first..self.runs.div_ceil(self.chunk)).step_by(step)
    }

    /// The runs of a chunk.
    pub fn runs_of(&self, chunk: u64) -> Range<u64> {
        let first = chunk * self.chunk;
        first..(first + self.chunk).min(self.runs)
    }

    /// Number of runs of this shard.
    pub fn own_runs(&self) -> u64 {
        self.chunks().map(|chunk| self.runs_of(chunk)).map(|runs| runs.end - runs.start).sum()
    }

    /// The row at which a chunk begins in the file of its shard.
    pub fn row_of(&self, chunk: u64) -> u64 {
        chunk / self.shard.of * self.chunk
    }
}

/// Why rows cannot be kept.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ChunksError {
    /// The file of rows.
    #[error("{}: {what}: {error}", path.display())]
    Rows {
        /// The file.
        path: PathBuf,
        /// Description of the failed operation.
        what: &'static str,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// The journal.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

/// A file of rows: a head, then rows of one width.
#[derive(Debug)]
pub struct RowFile {
    path: PathBuf,
    file: File,
    head: u64,
    width: u64,
}

impl RowFile {
    /// Opens a file for rows, or makes one: with this head, and room for so many rows.
    ///
    /// # Errors
    ///
    /// [`ChunksError::Rows`]
    pub fn open(path: &Path, head: &[u8], width: usize, rows: u64) -> Result<Self, ChunksError> {
        let told =
            |error| ChunksError::Rows { path: path.to_owned(), what: "cannot be made", error };
        let file = disk::open_in_place(path).map_err(told)?;
        let width = width as u64;
        let mut this = Self { path: path.to_owned(), file, head: head.len() as u64, width };
        let there = this.read_at(0, head.len()).ok();
        if there.as_deref() != Some(head) {
            this.write_at(0, head)?;
        }
        let length = this.head + rows * width;
        strike(Operation::Write, path)
            .and_then(|()| this.file.set_len(length))
            .and_then(|()| disk::sync_folder(disk::folder_of(path)))
            .map_err(told)?;
        Ok(this)
    }

    /// Opens a finished file.
    ///
    /// # Errors
    ///
    /// [`ChunksError::Rows`]: it cannot be opened, or has another head.
    pub fn finished(
        path: &Path,
        head: &[u8],
        width: usize,
        rows: u64,
    ) -> Result<Self, ChunksError> {
        let told =
            |error| ChunksError::Rows { path: path.to_owned(), what: "cannot be read", error };
        let file = File::open(path).map_err(told)?;
        let (width, head_length) = (width as u64, head.len() as u64);
        let length = file.metadata().map_err(told)?.len();
        let mut this = Self { path: path.to_owned(), file, head: head_length, width };
        if length != head_length + rows * width || this.read_at(0, head.len())? != head {
            return Err(told(std::io::Error::other("these are not the rows of this sweep")));
        }
        Ok(this)
    }

    fn told(&self, what: &'static str) -> impl Fn(std::io::Error) -> ChunksError + use<> {
        let path = self.path.clone();
        move |error| ChunksError::Rows { path: path.clone(), what, error }
    }

    fn read_at(&mut self, at: u64, length: usize) -> Result<Vec<u8>, ChunksError> {
        let mut bytes = vec![0; length];
        let read =
            self.file.seek(SeekFrom::Start(at)).and_then(|_| self.file.read_exact(&mut bytes));
        read.map_err(self.told("cannot be read"))?;
        Ok(bytes)
    }

    fn write_at(&mut self, at: u64, bytes: &[u8]) -> Result<(), ChunksError> {
        let there = self.file.seek(SeekFrom::Start(at));
        let path = self.path.clone();
        there
            .and_then(|_| disk::write_all(&mut self.file, &path, bytes))
            .map_err(self.told("cannot be written"))
    }

    /// Rows from one on.
    ///
    /// # Errors
    ///
    /// [`ChunksError::Rows`]
    pub fn rows(&mut self, first: u64, count: u64) -> Result<Vec<u8>, ChunksError> {
        let length = usize::try_from(count * self.width).unwrap_or(usize::MAX);
        self.read_at(self.head + first * self.width, length)
    }

    /// Puts rows in their place.
    ///
    /// # Errors
    ///
    /// [`ChunksError::Rows`]
    pub fn put(&mut self, first: u64, bytes: &[u8]) -> Result<(), ChunksError> {
        self.write_at(self.head + first * self.width, bytes)
    }

    /// Has the system keep what was written.
    ///
    /// # Errors
    ///
    /// [`ChunksError::Rows`]
    pub fn sync(&self) -> Result<(), ChunksError> {
        strike(Operation::Sync, &self.path)
            .and_then(|()| self.file.sync_data())
            .map_err(self.told("cannot be written"))
    }

    /// The SHA-256 of the whole file, hexadecimal.
    ///
    /// # Errors
    ///
    /// [`ChunksError::Rows`]
    pub fn sha256(&mut self) -> Result<String, ChunksError> {
        let told = self.told("cannot be read");
        self.file.seek(SeekFrom::Start(0)).and_then(|_| sha256(&mut self.file)).map_err(told)
    }

    /// Hands every row over, from the first on.
    ///
    /// # Errors
    ///
    /// [`ChunksError::Rows`]
    pub fn each(&mut self, rows: u64, mut each: impl FnMut(&[u8])) -> Result<(), ChunksError> {
        let told = self.told("cannot be read");
        self.file.seek(SeekFrom::Start(self.head)).map_err(&told)?;
        let mut file = BufReader::with_capacity(1 << 18, &self.file);
        let mut row = vec![0; usize::try_from(self.width).unwrap_or(0)];
        for _ in 0..rows {
            file.read_exact(&mut row).map_err(&told)?;
            each(&row);
        }
        Ok(())
    }
}

/// Computes the chunks of a shard that are missing. `plan` identifies everything that determines a row except
/// its position; `work` returns the rows of a range of runs and must depend on their positions alone.
/// `progress` is called with the number of finished runs, first with the number of those that were there
/// before.
///
/// # Errors
///
/// [`ChunksError`]: the disk does not take the rows; no further chunk is begun.
pub fn run_chunks(
    (file, journal): (&mut RowFile, &mut Journal),
    (plan, layout): (&str, &ChunkLayout),
    threads: usize,
    work: &(impl Fn(Range<u64>) -> Vec<u8> + Sync),
    mut progress: impl FnMut(u64),
) -> Result<(), ChunksError> {
    let length = |chunk: u64| layout.runs_of(chunk).end - layout.runs_of(chunk).start;
    let id = |chunk: u64| format!("{plan}/{chunk}");
    let (mut waiting, mut done) = (Vec::new(), 0);
    for chunk in layout.chunks() {
        let known =
            journal.entry(&id(chunk)).and_then(|sum| serde_json::from_str::<String>(sum).ok());
        let kept = match known {
            Some(known) => sum(&file.rows(layout.row_of(chunk), length(chunk))?) == known,
            None => false,
        };
        if kept { done += length(chunk) } else { waiting.push(chunk) }
    }
    progress(done);
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    // Whoever is far ahead of the disk waits for it: memory is bounded.
    let (sender, receiver) = mpsc::sync_channel(4 * threads.max(1));
    thread::scope(|scope| {
        for _ in 0..threads.clamp(1, waiting.len().max(1)) {
            let (sender, waiting, next, stop) = (sender.clone(), &waiting, &next, &stop);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed)
                    && let Some(&chunk) = waiting.get(next.fetch_add(1, Ordering::Relaxed))
                    && sender.send((chunk, work(layout.runs_of(chunk)))).is_ok()
                {}
            });
        }
        drop(sender);
        // Dropped with an error, it lets nobody wait for ever.
        let receiver = receiver;
        while let Some(group) = group(&receiver) {
            let kept = keep(file, journal, layout, &group, &id);
            kept.inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
            done += group.iter().map(|(chunk, _)| length(*chunk)).sum::<u64>();
            progress(done);
        }
        Ok(())
    })
}

/// Rows first, then the lines that say that they are there; each waits for the disk once.
fn keep(
    file: &mut RowFile,
    journal: &mut Journal,
    layout: &ChunkLayout,
    group: &[(u64, Vec<u8>)],
    id: &impl Fn(u64) -> String,
) -> Result<(), ChunksError> {
    for (chunk, rows) in group {
        file.put(layout.row_of(*chunk), rows)?;
    }
    file.sync()?;
    let lines: Vec<_> = group.iter().map(|(chunk, rows)| (id(*chunk), sum(rows))).collect();
    journal.append_all(lines.iter().map(|(id, sum)| (id.as_str(), sum)))?;
    Ok(())
}

/// The SHA-256 of some bytes.
fn sum(mut bytes: &[u8]) -> String {
    sha256(&mut bytes).unwrap_or_default()
}
