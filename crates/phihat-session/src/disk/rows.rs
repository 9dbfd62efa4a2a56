//! Files that grow in place, and single files that come and go: what a journal vouches for.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::Path;

use super::folder::{folder_of, sync_folder};
use super::seam::{Operation, strike};

/// Opens a file that is read and written in place, or makes it.
///
/// # Errors
///
/// What the system says.
pub fn open_in_place(path: &Path) -> io::Result<File> {
    strike(Operation::Open, path)?;
    OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)
}

/// Takes a file away, where there is one; it is gone from the disk when this returns.
///
/// # Errors
///
/// What the system says.
pub fn take_away(path: &Path) -> io::Result<()> {
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    strike(Operation::Remove, path)?;
    fs::remove_file(path)?;
    sync_folder(folder_of(path))
}

/// Moves a file to another place of the same folder; it is there on the disk when this returns.
///
/// # Errors
///
/// What the system says.
pub fn move_to(from: &Path, to: &Path) -> io::Result<()> {
    strike(Operation::Move, to)?;
    fs::rename(from, to)?;
    sync_folder(folder_of(to))
}
