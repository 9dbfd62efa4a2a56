//! Output files: written beside their place, then moved there, so that none is ever half-written.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use phihat_campaign::Journal;
use phihat_model::input;

use crate::failure::Failure;

/// Makes a folder, parents included.
pub(crate) fn make_folder(path: &Path) -> Result<(), Failure> {
    fs::create_dir_all(path).map_err(|e| Failure::at(path, format!("cannot be made: {e}")))
}

/// Whether every one of these files can be written: asked before what takes long, and nothing stays of the question.
///
/// Folders that there are not yet are not made; the nearest that there is has to take a file.
pub(crate) fn check_writable<'a>(
    all: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    for path in all {
        for taken in [path.clone(), partial_name(path)] {
            if taken.is_dir() {
                return Err(is_a_folder(&taken));
            }
        }
        let Some(nearest) = path.ancestors().skip(1).find(|folder| exists(folder)) else {
            continue;
        };
        let nearest = if nearest.as_os_str().is_empty() { Path::new(".") } else { nearest };
        if !nearest.is_dir() {
            return Err(Failure::at(nearest, "is not a folder: give --out a folder's name"));
        }
        let trial = nearest.join(format!(".phihat-{}.partial", std::process::id()));
        fs::write(&trial, "").map_err(|e| {
            Failure::at(
                path,
                format!("cannot be written: {} takes no file: {e}", nearest.display()),
            )
        })?;
        fs::remove_file(&trial).map_err(|e| Failure::at(&trial, e))?;
    }
    Ok(())
}

/// Whether there is something, were it a broken link; the empty path is the folder that the program runs in.
fn exists(path: &Path) -> bool {
    path.as_os_str().is_empty() || path.symlink_metadata().is_ok()
}

fn is_a_folder(path: &Path) -> Failure {
    Failure::at(path, "cannot be written: it is a folder")
}

/// Opens the journal of a campaign, or begins one; says which of its lines cannot be used.
pub(crate) fn open_journal(path: &Path, fresh: bool) -> Result<Journal, Failure> {
    if fresh && path.exists() {
        fs::remove_file(path).map_err(|e| Failure::at(path, e))?;
    }
    let journal = Journal::open(path).map_err(Failure::plain)?;
    if let Some(damage) = journal.damage() {
        eprintln!("{}: {damage}", path.display());
    }
    Ok(journal)
}

/// Writes a whole file.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    write_with(path, |file| file.write_all(text.as_bytes()).map_err(Failure::plain))
}

/// Writes all of them, folders included, or none: each beside its place, then all moved there.
pub(crate) fn write_all(all: &[(PathBuf, Vec<u8>)]) -> Result<(), Failure> {
    let beside = || -> Result<(), Failure> {
        for (path, bytes) in all {
            if let Some(folder) = path.parent() {
                make_folder(folder)?;
            }
            if path.is_dir() {
                return Err(is_a_folder(path));
            }
            fs::write(partial_name(path), bytes)
                .map_err(|e| Failure::at(path, format!("cannot be written: {e}")))?;
        }
        Ok(())
    };
    let moved = beside().and_then(|()| {
        all.iter().try_for_each(|(path, _)| {
            fs::rename(partial_name(path), path)
                .map_err(|e| Failure::at(path, format!("cannot be written: {e}")))
        })
    });
    if moved.is_err() {
        for (path, _) in all {
            // The failure is already being told; some were not written yet.
            let _ = fs::remove_file(partial_name(path));
        }
    }
    moved
}

/// Writes a file through a function; on any failure the place keeps what it had.
pub(crate) fn write_with(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let partial = partial_name(path);
    let cannot = |e: std::io::Error| Failure::at(path, format!("cannot be written: {e}"));
    let mut file = BufWriter::new(File::create(&partial).map_err(cannot)?);
    let written = fill(&mut file).and_then(|()| file.flush().map_err(cannot));
    drop(file);
    let moved = written.and_then(|()| fs::rename(&partial, path).map_err(cannot));
    if moved.is_err() {
        // The failure is already being told; a left-over partial file is named as such.
        let _ = fs::remove_file(&partial);
    }
    moved
}

/// Reads a text file.
pub(crate) fn read(path: &Path) -> Result<String, Failure> {
    input::text(path, input::DOCUMENT_MAX)
        .map_err(|e| Failure::at(path, format!("cannot be read: {e}")))
}

/// Opens a file for reading.
pub(crate) fn open(path: &Path) -> Result<File, Failure> {
    input::open(path).map_err(|e| Failure::at(path, format!("cannot be read: {e}")))
}

fn partial_name(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    path.with_file_name(name)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "in a test a panic is the report")]
mod tests {
    use super::{PathBuf, check_writable, fs, write_all};

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

    #[test]
    fn all_are_written_or_none() {
        let folder = std::env::temp_dir().join(format!("phihat-all-{}", std::process::id()));
        let at = |name: &str| folder.join(name);
        let all = |text: &str| [at("a"), at("b/c")].map(|path| (path, text.as_bytes().to_vec()));
        write_all(&all("old")).unwrap();
        fs::create_dir(at("taken")).unwrap();
        let with_bad = [&all("new")[..], &[(at("taken"), vec![1])]].concat();
        assert!(write_all(&with_bad).unwrap_err().to_string().contains("taken"));
        for (path, bytes) in all("old") {
            assert_eq!(fs::read(path).unwrap(), bytes);
        }
        let mut names: Vec<_> =
            fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["a", "b", "taken"], "nothing half-written is left");
        assert_eq!(fs::read_dir(at("b")).unwrap().count(), 1);
        fs::remove_dir_all(folder).unwrap();
    }
}
