//! Work that takes long: on how many threads, and who looks on.

use std::path::{Path, PathBuf};
use std::thread::available_parallelism;

use crate::record::Done;

/// Told how far a piece of work is; `()` looks away.
pub trait Watch: Send {
    /// So many of all are done.
    fn progress(&mut self, done: u64, all: u64) {
        let _ = (done, all);
    }

    /// The work up to here was done before, and says nothing about the time left.
    fn resumed(&mut self) {}

    /// Reports the journal that saves the finished work, from which the same work goes on.
    fn saved_in(&mut self, journal: &Path) {
        let _ = journal;
    }

    /// Reports the current step, in a few words.
    fn step(&mut self, what: &str) {
        let _ = what;
    }

    /// Reports a line that is worth knowing before the end.
    fn warn(&mut self, line: &str) {
        let _ = line;
    }

    /// From here on these files are on their way, and worth nothing unless they are finished.
    fn begun(&mut self, unfinished: &[PathBuf]) {
        let _ = unfinished;
    }

    /// The work is over; what is left is written whole or not at all.
    fn ended(&mut self) {}

    /// Reports the result of a run, before its files are written.
    fn came_to(&mut self, done: &Done) {
        let _ = done;
    }
}

impl Watch for () {}

/// Runs at a time: the requested number, else one per core.
pub fn threads(asked: Option<u16>) -> usize {
    asked.map_or_else(|| available_parallelism().map_or(1, usize::from), usize::from)
}
