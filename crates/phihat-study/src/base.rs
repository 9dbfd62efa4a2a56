//! Where the files are that a study names.

use std::path::{Path, PathBuf};

/// What files are relative to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Base<'a> {
    pub(crate) folder: &'a Path,
    /// Whether the files are in that folder, whatever folder a study names.
    pub(crate) flat: bool,
}

impl Base<'_> {
    /// Where a file is.
    pub(crate) fn join(&self, named: &str) -> PathBuf {
        let name = Path::new(named).file_name().filter(|_| self.flat);
        self.folder.join(name.map_or(Path::new(named), Path::new))
    }
}

/// Where a file was looked for that is not there; nothing where there is something.
pub(crate) fn beside(path: &Path) -> String {
    if path.exists() {
        return String::new();
    }
    format!("looked for as `{}`: names are relative to the study's folder", path.display())
}
