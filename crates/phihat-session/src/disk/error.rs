//! Why files could not be written.

use core::fmt;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why files could not be written, and what is there now.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DiskError {
    /// Nothing on the disk has changed.
    #[error("{}: cannot be written: {why}\n  = note: nothing that was there has changed", path.display())]
    Untouched {
        /// Path that could not be written.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// The older files are no longer whole, and the new ones not yet.
    #[error(
        "{}: cannot be written: {why}\n  = note: the older results were taken away; new: {}; not written: {}; the same \
         command again writes all of them", path.display(), FileNames(new), FileNames(missing)
    )]
    Broken {
        /// Path that could not be written, moved or removed.
        path: PathBuf,
        /// Why.
        why: String,
        /// Files in their places.
        new: Vec<PathBuf>,
        /// Files that are not.
        missing: Vec<PathBuf>,
    },
    /// All files are in their places; whether they outlive a power cut is not known.
    #[error(
        "{}: every file was written, but the disk did not confirm it: {why}\n  = note: after a power cut they may be \
         missing; the same command again writes them", path.display()
    )]
    Unconfirmed {
        /// The folder.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// Another process is at work in this folder.
    #[error(
        "{}: another phihat is at work in this folder; wait for it, or choose another folder", .0.display()
    )]
    Busy(PathBuf),
}

impl DiskError {
    /// A file that cannot be written, before anything that was there has changed.
    pub fn untouched(path: &Path, why: impl fmt::Display) -> Self {
        Self::Untouched { path: path.to_owned(), why: why.to_string() }
    }
}

/// File names for people.
struct FileNames<'a>(&'a [PathBuf]);

/// Names that are told.
const SHOWN: usize = 10;

impl fmt::Display for FileNames<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name =
            |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let names: Vec<_> = self.0.iter().take(SHOWN).map(name).collect();
        match self.0.len().saturating_sub(SHOWN) {
            0 if names.is_empty() => f.write_str("none"),
            0 => f.write_str(&names.join(", ")),
            more => write!(f, "{} and {more} more", names.join(", ")),
        }
    }
}
