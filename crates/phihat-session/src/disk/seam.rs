//! Hook by which a test makes the disk fail. Every operation of a writer calls it first.
//!
//! Without debug assertions, as in a release build, the answer is always yes and nothing of this is compiled.
//! With them, the environment's `PHIHAT_STRIKE` names an operation by its number, from 1: `fail 7` has it
//! fail, half-done where it is a write; `full 7` has this one and all later ones fail that need room;
//! `kill 7` ends the process there. `pause 7` keeps the process there until a signal ends it; `pass 7` lets
//! it go on, and says on the standard error output, as the others do, how far it came. With a third word, as
//! in `pause 4 journal.jsonl`, only operations on paths that contain the word are numbered.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// Operation that a writer is about to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// Make a file under a new name.
    Create,
    /// Open a file.
    Open,
    /// Lock one.
    Lock,
    /// Write to one.
    Write,
    /// Make the system keep what was written.
    Sync,
    /// Move a file to its place.
    Move,
    /// Take one away.
    Remove,
    /// Make a folder.
    MakeFolder,
}

/// Checks that an operation may go on.
#[cfg(not(debug_assertions))]
#[inline]
#[allow(clippy::unnecessary_wraps, reason = "the same call with and without debug assertions")]
pub fn strike(_operation: Operation, _path: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(debug_assertions)]
pub use armed::strike;

/// Writes all bytes.
///
/// # Errors
///
/// Error of the operating system.
pub fn write_all(file: &mut File, path: &Path, bytes: &[u8]) -> io::Result<()> {
    #[cfg(debug_assertions)]
    if armed::is_next(path) {
        // What fails has often begun.
        file.write_all(&bytes[..bytes.len() / 2])?;
    }
    strike(Operation::Write, path)?;
    file.write_all(bytes)
}

#[cfg(debug_assertions)]
mod armed {
    use std::io::{self, ErrorKind};
    use std::path::Path;
    use std::sync::LazyLock;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;

    use super::Operation;

    /// Exit code that a shell reports for a killed process.
    const KILLED: i32 = 137;

    /// Plan of a strike.
    struct StrikePlan {
        how: String,
        /// Number of the first operation that is struck.
        from: usize,
        /// Word in the paths whose operations are numbered.
        word: String,
    }

    impl StrikePlan {
        fn numbers(&self, path: &Path) -> bool {
            path.to_string_lossy().contains(&self.word)
        }
    }

    static PLAN: LazyLock<Option<StrikePlan>> = LazyLock::new(|| {
        let text = std::env::var("PHIHAT_STRIKE").ok()?;
        let (how, rest) = text.split_once(' ')?;
        let (number, word) = rest.split_once(' ').unwrap_or((rest, ""));
        Some(StrikePlan { how: how.to_owned(), from: number.parse().ok()?, word: word.to_owned() })
    });
    static DONE: AtomicUsize = AtomicUsize::new(0);

    /// Returns true if the next operation, on this path, is not done to its end.
    pub(super) fn is_next(path: &Path) -> bool {
        let Some(plan) = PLAN.as_ref().filter(|plan| plan.numbers(path)) else { return false };
        let next = DONE.load(Ordering::Relaxed) + 1;
        match plan.how.as_str() {
            "pass" => false,
            "full" => next >= plan.from,
            _ => next == plan.from,
        }
    }

    /// Checks that an operation may go on.
    ///
    /// # Errors
    ///
    /// The requested strike.
    #[allow(clippy::print_stderr, reason = "the test reads whether it struck, and what")]
    pub fn strike(operation: Operation, path: &Path) -> io::Result<()> {
        let Some(plan) = PLAN.as_ref().filter(|plan| plan.numbers(path)) else { return Ok(()) };
        let StrikePlan { how, from, .. } = plan;
        let number = DONE.fetch_add(1, Ordering::Relaxed) + 1;
        let roomless = matches!(operation, Operation::Move | Operation::Remove | Operation::Lock);
        let struck =
            number == *from && how != "full" || how == "full" && number >= *from && !roomless;
        if !struck {
            return Ok(());
        }
        eprintln!("struck: {how} {number}: {operation:?} {}", path.display());
        match how.as_str() {
            "kill" => std::process::exit(KILLED),
            // Whatever unparks a thread: only a signal leads out of here.
            "pause" => loop {
                thread::park();
            },
            "pass" => Ok(()),
            _ => Err(ErrorKind::StorageFull.into()),
        }
    }
}
