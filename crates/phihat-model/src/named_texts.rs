//! Files by name: those of the disk, or texts in their place.

use std::collections::BTreeMap;
use std::io::{Cursor, Error, ErrorKind, Read, Result};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use crate::input;

/// Name of a file, and the source of the files that it includes.
pub(crate) type NamedFile<'a> = (&'a NamedTexts, &'a Path);

/// Source of the files that somebody names: the disk, or texts that stand in their place.
///
/// # Example
///
/// ```
/// use phihat_model::{NamedTexts, Part, Robot};
/// use std::path::Path;
///
/// let urdf = Robot::named("planar3r")?.urdf()?;
/// let files = NamedTexts::alone([("arm.urdf".into(), urdf)]);
/// let arm = Robot::read_from(&files, Path::new("arm.urdf"), &Part::default())?;
/// assert_eq!(arm.joints.len(), 3);
/// // Nothing else is there, whatever is on the disk.
/// assert!(Robot::read_from(&files, Path::new("other.urdf"), &Part::default()).is_err());
/// # Ok::<(), phihat_model::RobotError>(())
/// ```
#[derive(Debug, Clone)]
pub struct NamedTexts {
    texts: Option<Arc<BTreeMap<PathBuf, String>>>,
    /// True if files without a text are those of the disk.
    disk: bool,
}

impl Default for NamedTexts {
    fn default() -> Self {
        Self::DISK
    }
}

impl NamedTexts {
    /// The disk alone.
    pub const DISK: Self = Self { texts: None, disk: true };

    /// Texts by their names alone: the disk is not looked at. A text is found by the name of its file too, where no
    /// other has the same: who hands files over may not know their folders.
    pub fn alone(texts: impl IntoIterator<Item = (PathBuf, String)>) -> Self {
        let texts = texts.into_iter().map(|(path, text)| (plain(&path), text));
        Self { texts: Some(Arc::new(texts.collect())), disk: false }
    }

    /// These files with further texts, each in place of a file of its name.
    #[must_use]
    pub fn with(&self, texts: impl IntoIterator<Item = (PathBuf, String)>) -> Self {
        let mut all = self.texts.as_deref().cloned().unwrap_or_default();
        all.extend(texts.into_iter().map(|(path, text)| (plain(&path), text)));
        Self { texts: Some(Arc::new(all)), disk: self.disk }
    }

    /// True if a file of this name is there.
    pub fn is_file(&self, path: &Path) -> bool {
        self.has_text(path) || (self.disk && path.is_file())
    }

    /// True if a text stands in place of the file of this name.
    pub fn has_text(&self, path: &Path) -> bool {
        self.text_of(path).is_some()
    }

    /// A reader of a file, and its size \[bytes\].
    ///
    /// # Errors
    ///
    /// As [`input::open`]; that no text has this name.
    pub fn open(&self, path: &Path) -> Result<(Box<dyn Read>, u64)> {
        if let Some(text) = self.text_of(path) {
            let bytes = text.as_bytes().to_vec();
            let size = bytes.len() as u64;
            return Ok((Box::new(Cursor::new(bytes)), size));
        }
        if !self.disk {
            return Err(Error::new(ErrorKind::NotFound, "no file of this name was given"));
        }
        let file = input::open(path)?;
        let size = file.metadata()?.len();
        Ok((Box::new(file), size))
    }

    /// The text of a file of at most so many bytes.
    ///
    /// # Errors
    ///
    /// As [`input::text`]; that no text has this name.
    pub fn text(&self, path: &Path, most: u64) -> Result<String> {
        input::limited(self.open(path)?.0, most)
    }

    /// True if files without a text are those of the disk.
    pub(crate) fn reads_disk(&self) -> bool {
        self.disk
    }

    fn text_of(&self, path: &Path) -> Option<&String> {
        let texts = self.texts.as_ref()?;
        if let Some(text) = texts.get(&plain(path)) {
            return Some(text);
        }
        let mut alike = texts.iter().filter(|(own, _)| own.file_name() == path.file_name());
        let (_, text) = alike.next().filter(|_| !self.disk)?;
        alike.next().is_none().then_some(text)
    }
}

/// A path without steps to the folder that it is in already.
fn plain(path: &Path) -> PathBuf {
    path.components().filter(|part| *part != Component::CurDir).collect()
}
