//! Documents and samples that nobody would write, against everything that reads them.
//!
//! A *target* takes bytes and panics where a promise is broken: a reader panics, what it accepts does not read back as
//! it was, a torque leaves its limits. [`mutated`] makes bytes from good documents and a recipe; the tests draw the
//! recipes. What breaks a target is kept in `corpus/TARGET/` and tried first from then on.
#![forbid(unsafe_code)]
#![allow(clippy::panic, reason = "a target panics where a promise is broken")]

mod choices;
mod drawn;
mod interface;
mod mutate;
mod readers;
mod samples;

use std::fs;
use std::path::{Path, PathBuf};

pub use choices::Choices;
pub use drawn::drawn;
pub use interface::fci;
pub use mutate::{mutated, overwritten};
pub use readers::{
    gains, journal, mjcf, reference_csv, robot_file, study, trace, trace_parquet, urdf,
};
pub use samples::{law, supervisor};

/// The project's folder.
#[must_use]
pub fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Documents to begin with: those of a folder of the project that end so, and what once broke the target.
///
/// # Panics
///
/// A folder cannot be read: there is nothing to begin with.
#[must_use]
pub fn seeds(target: &str, folder: &str, ending: &str) -> Vec<Vec<u8>> {
    let mut paths: Vec<PathBuf> = Vec::new();
    for (folder, all) in [(project().join(folder), false), (kept(target), true)] {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        let files = entries.filter_map(|entry| Some(entry.ok()?.path()));
        paths.extend(
            files.filter(|p| p.is_file() && (all || p.to_string_lossy().ends_with(ending))),
        );
    }
    paths.sort();
    let seeds: Vec<Vec<u8>> = paths.iter().filter_map(|path| fs::read(path).ok()).collect();
    assert!(!seeds.is_empty(), "no seeds for {target}");
    seeds
}

/// Folder of the stored inputs that broke a target.
#[must_use]
pub fn kept(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target)
}
