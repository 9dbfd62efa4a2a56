//! Output files, through the one way to the disk; what goes wrong there is told to people.

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::disk::{Lock, Whole, folder_of, takes_files};
use phihat_design::Gains;
use phihat_model::input;

use crate::error::SessionError;

/// Checks that every one of these files can be written, before work that takes long; leaves nothing behind.
///
/// Missing folders are not made; the nearest one that exists has to take a file.
///
/// # Errors
///
/// [`SessionError::File`], naming the file or the folder that is in the way.
pub fn check_writable<'a>(all: impl IntoIterator<Item = &'a PathBuf>) -> Result<(), SessionError> {
    for path in all {
        if path.is_dir() {
            return Err(SessionError::at(path, "cannot be written: it is a folder"));
        }
        let Some(nearest) = path.ancestors().skip(1).find(|folder| exists(folder)) else {
            continue;
        };
        let nearest = if nearest.as_os_str().is_empty() { Path::new(".") } else { nearest };
        if !nearest.is_dir() {
            return Err(SessionError::at(nearest, "is not a folder: give --out a folder's name"));
        }
        takes_files(nearest).map_err(|e| {
            SessionError::at(
                path,
                format!("cannot be written: {} takes no file: {e}", nearest.display()),
            )
        })?;
    }
    Ok(())
}

/// Returns true if the path exists, even as a broken link; the empty path is the working folder.
fn exists(path: &Path) -> bool {
    path.as_os_str().is_empty() || path.symlink_metadata().is_ok()
}

/// Writes a file alone, at once or not at all.
///
/// # Errors
///
/// [`SessionError::Disk`]
pub fn write(path: &Path, text: &str) -> Result<(), SessionError> {
    let held = Lock::take_if_used(folder_of(path))?;
    let mut whole = Whole::where_held(held.as_ref());
    whole.add(path, text.as_bytes())?;
    Ok(whole.commit()?)
}

/// Writes files that belong together, the last one last, in a folder that the caller keeps others out of.
///
/// # Errors
///
/// [`SessionError::Disk`]
pub fn write_locked(all: &[(PathBuf, Vec<u8>)]) -> Result<(), SessionError> {
    let mut whole = Whole::in_locked_folder();
    for (path, bytes) in all {
        whole.add(path, bytes)?;
    }
    Ok(whole.commit()?)
}

/// Reads a text file.
///
/// # Errors
///
/// [`SessionError::File`]
pub fn read(path: &Path) -> Result<String, SessionError> {
    input::text(path, input::DOCUMENT_MAX)
        .map_err(|e| SessionError::at(path, format!("cannot be read: {e}")))
}

/// Opens a file for reading.
///
/// # Errors
///
/// [`SessionError::File`]
pub fn open(path: &Path) -> Result<File, SessionError> {
    input::open(path).map_err(|e| SessionError::at(path, format!("cannot be read: {e}")))
}

/// Reads gains from their file.
///
/// # Errors
///
/// [`SessionError::File`]: it cannot be read, or holds no gains.
pub fn read_gains(path: &Path) -> Result<Gains, SessionError> {
    Gains::from_json(&read(path)?).map_err(|why| SessionError::at(path, why))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "in a test a panic is the report")]
mod tests {
    use std::fs;

    use super::{PathBuf, check_writable};

    #[test]
    fn what_cannot_be_written_is_told_before_and_nothing_stays_of_the_question() {
        let folder = std::env::temp_dir().join(format!("phihat-ask-{}", std::process::id()));
        fs::create_dir_all(folder.join("taken")).unwrap();
        fs::write(folder.join("file"), "").unwrap();
        let ask = |name: &str| check_writable(&[folder.join(name)]).map_err(|e| e.to_string());
        assert_eq!(ask("new/deep/report.html"), Ok(()));
        assert_eq!(ask("file"), Ok(()));
        assert!(ask("taken").unwrap_err().contains("it is a folder"));
        assert!(ask("file/report.html").unwrap_err().contains("is not a folder"));
        // No file can be made there, whoever asks.
        let nowhere = check_writable(&[PathBuf::from("/proc/phihat/report.html")]);
        assert!(!cfg!(target_os = "linux") || nowhere.is_err());
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
        fs::remove_dir_all(folder).unwrap();
    }
}
