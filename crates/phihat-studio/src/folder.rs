//! The working folder: the only place where a studio reads or writes.

use std::path::{Component, Path, PathBuf};

use phihat_session::files;
use toml::{Table, Value};

use crate::error::StudioError;

/// Letters of a name at most.
const NAME_MAX: usize = 80;

/// The folder, as the system names it.
#[derive(Debug, Clone)]
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn at(path: &Path) -> Result<Self, StudioError> {
        let found = path.canonicalize();
        found.map(Self).map_err(|why| StudioError::refused(format!("{}: {why}", path.display())))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// Path of a study of this name: letters, digits, `-`, `_`; nothing that leads elsewhere.
    pub(crate) fn place(&self, name: &str) -> Result<PathBuf, StudioError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if name.is_empty() || name.len() > NAME_MAX || !name.chars().all(plain) {
            return Err(StudioError::refused(
                "a name has letters, digits, - and _, 80 at most; the ending is added",
            ));
        }
        Ok(self.0.join(format!("{name}.toml")))
    }

    /// Writes files, all whole, where there is nothing yet; a link counts as something.
    pub(crate) fn write(&self, all: &[(PathBuf, String)]) -> Result<(), StudioError> {
        for (path, _) in all {
            let inside = path.parent() == Some(&self.0);
            if !inside {
                return Err(StudioError::refused("not in the working folder"));
            }
            if path.symlink_metadata().is_ok() {
                let name = path.file_name().unwrap_or_default().display();
                return Err(StudioError::refused(format!(
                    "there is a {name} already: another name"
                )));
            }
        }
        for (path, text) in all {
            files::write(path, text)?;
        }
        Ok(())
    }

    /// That a study names no file outside of the folder. What it says of the world outside, found or not, is the same.
    pub(crate) fn holds(&self, text: &str) -> Result<(), StudioError> {
        let Ok(table) = text.parse::<Table>() else { return Ok(()) };
        let named = table.iter().filter(|(key, _)| *key != "title");
        for (_, value) in named {
            self.value(value)?;
        }
        Ok(())
    }

    fn value(&self, value: &Value) -> Result<(), StudioError> {
        match value {
            Value::String(word) => self.word(word),
            Value::Array(list) => list.iter().try_for_each(|value| self.value(value)),
            Value::Table(table) => table.values().try_for_each(|value| self.value(value)),
            _ => Ok(()),
        }
    }

    fn word(&self, word: &str) -> Result<(), StudioError> {
        let outside = || {
            StudioError::refused(format!(
                "{word:?} may be a file outside of the working folder: a studio reads none"
            ))
        };
        let path = Path::new(word);
        let plain =
            path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
        if !plain || word.contains(['\\', '\0']) || word.contains("://") {
            return Err(outside());
        }
        match self.0.join(path).canonicalize() {
            Ok(real) if !real.starts_with(&self.0) => Err(outside()),
            _ => Ok(()),
        }
    }
}
