//! Lines of code that a file rests on: its own, and those of the files that it uses, and so on.

use std::collections::{BTreeMap, BTreeSet};

use super::tree::ModuleTree;
use super::uses::{Arrows, arrows};

/// Files of a crate with their lines of code, and who uses whom.
pub(crate) struct SourceLines {
    pub(crate) name: String,
    lines: BTreeMap<String, usize>,
    arrows: Arrows,
}

impl SourceLines {
    pub(super) fn of(name: String, tree: &ModuleTree) -> Self {
        let lines = tree.files.iter().map(|(file, own)| (file.clone(), own.code)).collect();
        Self { name, lines, arrows: arrows(tree) }
    }

    /// Lines of all files.
    pub(crate) fn whole(&self) -> usize {
        self.lines.values().sum()
    }

    /// Lines of these files and of all that they use; at a file of `ends` the way ends.
    pub(crate) fn reached(&self, files: &[&str], ends: &[&str]) -> Result<usize, String> {
        let (mut found, mut open) = (BTreeSet::new(), files.to_vec());
        while let Some(file) = open.pop() {
            let at = self.lines.get_key_value(file);
            let (file, _) = at.ok_or_else(|| format!("{}: no file {file}", self.name))?;
            if !ends.contains(&file.as_str()) && found.insert(file) {
                open.extend(
                    self.arrows.get(file).into_iter().flat_map(BTreeMap::keys).map(String::as_str),
                );
            }
        }
        Ok(found.into_iter().map(|file| self.lines[file]).sum())
    }
}
