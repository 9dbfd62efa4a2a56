//! One process at a time in a folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::thread;
use std::time::Duration;

use super::error::DiskError;
use super::folder::make_folder;
use super::seam::{Operation, strike};

/// A folder that no other process writes to until this is dropped, or its process ends in any way.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

/// The file that is locked. It stays: whoever removed it could let two processes lock two files of this name.
const NAME: &str = ".phihat.lock";

/// Number of attempts to take a lock, 10 ms apart.
const PATIENCE: usize = 15;

impl Lock {
    /// Locks a folder, which is made where there is none.
    ///
    /// # Errors
    ///
    /// [`DiskError`]: another process has it, or no file can be made there.
    pub fn take(folder: &Path) -> Result<Self, DiskError> {
        let file = make_folder(folder).and_then(|()| open(folder, true));
        Self::of(folder, file)
    }

    /// Locks a folder if any process ever locked it; otherwise nothing is written there.
    ///
    /// # Errors
    ///
    /// [`DiskError`]: another process has it.
    pub fn take_if_used(folder: &Path) -> Result<Option<Self>, DiskError> {
        match open(folder, false) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            file => Self::of(folder, file).map(Some),
        }
    }

    fn of(folder: &Path, file: io::Result<File>) -> Result<Self, DiskError> {
        let path = folder.join(NAME);
        let refuse =
            |why: io::Error| DiskError::Untouched { path: path.clone(), why: why.to_string() };
        let file = file.map_err(refuse)?;
        if locked(&file, &path).map_err(refuse)? {
            return Ok(Self { _file: file });
        }
        Err(DiskError::Busy(folder.to_owned()))
    }
}

/// Locks an open file; returns false if another process has locked it.
///
/// It waits a little: a process that this one starts has a copy of every lock until it has become another program.
///
/// # Errors
///
/// Error of the operating system.
pub fn locked(file: &File, path: &Path) -> io::Result<bool> {
    strike(Operation::Lock, path)?;
    for _ in 0..PATIENCE {
        match file.try_lock() {
            Ok(()) => return Ok(true),
            Err(TryLockError::WouldBlock) => thread::sleep(Duration::from_millis(10)),
            Err(TryLockError::Error(error)) => return Err(error),
        }
    }
    Ok(false)
}

fn open(folder: &Path, make: bool) -> io::Result<File> {
    let path = folder.join(NAME);
    // A device or a pipe of this name would be opened, and might hold the program up.
    if path.symlink_metadata().is_ok_and(|found| !found.is_file()) {
        return Err(io::Error::other("it is not a file"));
    }
    strike(Operation::Open, &path)?;
    OpenOptions::new().write(true).create(make).truncate(false).open(path)
}
