//! Folders: made, named, synced.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::Path;

use super::seam::{Operation, strike};

/// Makes a folder, parents included; what is new is synced.
///
/// # Errors
///
/// Error of the operating system.
pub fn make_folder(path: &Path) -> io::Result<()> {
    if path.as_os_str().is_empty() || path.is_dir() {
        return Ok(());
    }
    let parent = folder_of(path);
    make_folder(parent)?;
    strike(Operation::MakeFolder, path)?;
    match fs::create_dir(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists && path.is_dir() => Ok(()),
        made => made.and_then(|()| sync_folder(parent)),
    }
}

/// The folder that a file is in; the empty path is the folder that the program runs in.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Syncs the entries of a folder to the disk; does nothing where folders cannot be synced.
///
/// # Errors
///
/// Error of the operating system.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    strike(Operation::Sync, folder)?;
    if cfg!(not(unix)) {
        return Ok(());
    }
    match File::open(folder)?.sync_all() {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => {
            Ok(())
        }
        synced => synced,
    }
}
