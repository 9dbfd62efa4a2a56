//! Who looks on while something takes long.

use std::path::PathBuf;

/// Told how far a piece of work is; `()` looks away.
pub trait Watch: Send {
    /// So many of all are done.
    fn progress(&mut self, done: u64, all: u64) {
        let _ = (done, all);
    }

    /// So much was done before, and says nothing about the time left.
    fn resumed(&mut self, done: u64) {
        let _ = done;
    }

    /// What is being done now, in a few words.
    fn step(&mut self, what: &str) {
        let _ = what;
    }

    /// A line that is worth knowing before the end.
    fn warn(&mut self, line: &str) {
        let _ = line;
    }

    /// From here on these files are on their way, and worth nothing unless they are finished.
    fn begun(&mut self, unfinished: &[PathBuf]) {
        let _ = unfinished;
    }

    /// The work is over; what is left is written whole or not at all.
    fn ended(&mut self) {}
}

impl Watch for () {}
