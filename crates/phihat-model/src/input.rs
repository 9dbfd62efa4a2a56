//! Files that people name: regular ones, of a size that is bounded; and what is told of them.

use std::fs::File;
use std::io::{Error, ErrorKind, Read as _, Result};
use std::path::Path;

/// Largest document, such as gains, that anything of ours writes \[bytes\].
pub const DOCUMENT_MAX: u64 = 1 << 28;

/// Opens a file for reading; a device, a pipe or a folder is none, and is not waited for.
///
/// # Errors
///
/// The system's error, or that the path is no regular file.
pub fn open(path: &Path) -> Result<File> {
    let about = std::fs::metadata(path)?;
    if about.is_file() {
        return File::open(path);
    }
    let what = if about.is_dir() { "a folder" } else { "a device or a pipe" };
    Err(Error::new(ErrorKind::InvalidInput, format!("it is {what}; a file is needed")))
}

/// The text of a file of at most so many bytes.
///
/// # Errors
///
/// As for [`open`]; a larger file; bytes that are not UTF-8.
pub fn text(path: &Path, most: u64) -> Result<String> {
    limited(open(path)?, most)
}

/// The text that a reader gives, of at most so many bytes.
pub(crate) fn limited(from: impl std::io::Read, most: u64) -> Result<String> {
    let mut bytes = Vec::new();
    from.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let why = format!("it is larger than the {most} bytes that are read");
        return Err(Error::new(ErrorKind::FileTooLarge, why));
    }
    let invalid = |_| Error::new(ErrorKind::InvalidData, "it is not UTF-8 text");
    String::from_utf8(bytes).map_err(invalid)
}

/// A text for a terminal: what it would obey, other than line ends and tabs, is written out.
#[must_use]
pub fn plain(text: &str) -> String {
    let obeyed = |c: char| c.is_control() && c != '\n' && c != '\t';
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if obeyed(c) { out.extend(c.escape_default()) } else { out.push(c) }
    }
    out
}
