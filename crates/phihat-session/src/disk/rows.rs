//! Files that grow in place, and single files that come and go: what a journal vouches for.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::folder::{folder_of, sync_folder};
use super::seam::{Operation, strike, write_all};

/// A file that grows at its end: written data outlives the process, whatever ends it. It may not outlive a
/// power cut: that depends on the operating system.
#[derive(Debug)]
pub struct Growing {
    file: File,
    path: PathBuf,
}

impl Growing {
    /// Makes one, where there is none.
    ///
    /// # Errors
    ///
    /// Error of the operating system.
    pub fn new(path: &Path) -> io::Result<Self> {
        strike(Operation::Create, path)?;
        Ok(Self { file: File::create_new(path)?, path: path.to_owned() })
    }
}

impl Write for Growing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        write_all(&mut self.file, &self.path, bytes)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Opens a file that is read and written in place, or makes it.
///
/// # Errors
///
/// Error of the operating system.
pub fn open_in_place(path: &Path) -> io::Result<File> {
    strike(Operation::Open, path)?;
    OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)
}

/// Takes a file away, where there is one; it is gone from the disk when this returns.
///
/// # Errors
///
/// Error of the operating system.
pub fn take_away(path: &Path) -> io::Result<()> {
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    strike(Operation::Remove, path)?;
    fs::remove_file(path)?;
    sync_folder(folder_of(path))
}

/// Takes a folder away with all that is in it, where there is one.
///
/// # Errors
///
/// Error of the operating system.
pub fn take_folder_away(path: &Path) -> io::Result<()> {
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    strike(Operation::Remove, path)?;
    fs::remove_dir_all(path)
}

/// Moves a file to another place of the same folder; it is there on the disk when this returns.
///
/// # Errors
///
/// Error of the operating system.
pub fn move_to(from: &Path, to: &Path) -> io::Result<()> {
    strike(Operation::Move, to)?;
    fs::rename(from, to)?;
    sync_folder(folder_of(to))
}
