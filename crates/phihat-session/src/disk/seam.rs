//! Where a test makes the disk fail. Every operation of a writer asks here first.
//!
//! Without debug assertions, as in a release build, the answer is always yes and nothing of this is compiled. With them,
//! the environment's `PHIHAT_STRIKE` names an operation by its number, from 1: `fail 7` has it fail, half-done where it is
//! a write; `full 7` has this one and all later ones fail that need room; `kill 7` ends the process there.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// What a writer is about to do.
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

/// Whether an operation may go on.
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
/// What the system says.
pub fn write_all(file: &mut File, path: &Path, bytes: &[u8]) -> io::Result<()> {
    #[cfg(debug_assertions)]
    if armed::is_next() {
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

    use super::Operation;

    /// What a shell says of a process that was killed.
    const KILLED: i32 = 137;

    /// What is struck: how, and from which operation on.
    static PLAN: LazyLock<Option<(String, usize)>> = LazyLock::new(|| {
        let text = std::env::var("PHIHAT_STRIKE").ok()?;
        let (how, number) = text.split_once(' ')?;
        Some((how.to_owned(), number.parse().ok()?))
    });
    static DONE: AtomicUsize = AtomicUsize::new(0);

    /// Whether the next operation is the one that is struck.
    pub(super) fn is_next() -> bool {
        let next = DONE.load(Ordering::Relaxed) + 1;
        PLAN.as_ref().is_some_and(|(how, from)| next == *from || (how == "full" && next > *from))
    }

    /// Whether an operation may go on.
    ///
    /// # Errors
    ///
    /// The strike that was asked for.
    #[allow(clippy::print_stderr, reason = "the test reads whether it struck, and what")]
    pub fn strike(operation: Operation, path: &Path) -> io::Result<()> {
        let Some((how, from)) = &*PLAN else { return Ok(()) };
        let number = DONE.fetch_add(1, Ordering::Relaxed) + 1;
        let roomless = matches!(operation, Operation::Move | Operation::Remove | Operation::Lock);
        let struck =
            number == *from && how != "full" || how == "full" && number >= *from && !roomless;
        if !struck {
            return Ok(());
        }
        eprintln!("struck: {how} {number}: {operation:?} {}", path.display());
        if how == "kill" {
            std::process::exit(KILLED);
        }
        Err(ErrorKind::StorageFull.into())
    }
}
