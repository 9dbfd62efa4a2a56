//! Output files: written beside their place, then moved there, so that none is ever half-written.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// Makes a folder, parents included.
pub(crate) fn make_folder(path: &Path) -> Result<(), Failure> {
    fs::create_dir_all(path).map_err(|e| Failure::at(path, format!("cannot be made: {e}")))
}

/// Writes a whole file.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    write_with(path, |file| file.write_all(text.as_bytes()).map_err(Failure::plain))
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
    fs::read_to_string(path).map_err(|e| Failure::at(path, format!("cannot be read: {e}")))
}

fn partial_name(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    path.with_file_name(name)
}
