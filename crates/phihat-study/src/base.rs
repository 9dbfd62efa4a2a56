//! Location of the files that a study names.

use std::path::{Path, PathBuf};

use phihat_model::NamedTexts;

/// Folder that files are relative to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Base<'a> {
    pub(crate) folder: &'a Path,
    /// Source of the files.
    pub(crate) files: &'a NamedTexts,
    /// True if the files are in that folder, whatever folder a study names.
    pub(crate) flat: bool,
}

impl Base<'_> {
    /// Path at which a missing file was expected, as a sentence; empty if something is there.
    pub(crate) fn beside(&self, path: &Path) -> String {
        if self.files.is_file(path) || path.exists() {
            return String::new();
        }
        format!("looked for as `{}`: names are relative to the study's folder", path.display())
    }

    /// Path of a file.
    pub(crate) fn join(&self, named: &str) -> PathBuf {
        let name = Path::new(named).file_name().filter(|_| self.flat);
        self.folder.join(name.map_or(Path::new(named), Path::new))
    }
}
