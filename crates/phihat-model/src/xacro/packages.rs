//! Folders of ROS packages, for `$(find NAME)`.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use super::reason::{Reasoned, reason};
use crate::named_texts::NamedTexts;

/// Folders above a file that are looked into.
const ABOVE_MAX: usize = 8;

/// Folders of a path of the environment that are looked into.
const LISTED_MAX: usize = 2000;

/// The folder of a package: as stated; installed (`AMENT_PREFIX_PATH`, `ROS_PACKAGE_PATH`); above the file, or
/// beside a folder above it. Among texts it has no place but its name.
pub(super) fn find(
    name: &str,
    (stated, files): (&BTreeMap<String, PathBuf>, &NamedTexts),
    file: &Path,
) -> Reasoned<PathBuf> {
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
    if name.is_empty() || name.starts_with('.') || !name.chars().all(plain) {
        return Err(reason!("$(find {name}): this is no package's name"));
    }
    if let Some(folder) = stated.get(name) {
        return Ok(folder.clone());
    }
    if !files.reads_disk() {
        return Ok(PathBuf::from(name));
    }
    let found = installed(name).or_else(|| above(name, file));
    found.ok_or_else(|| {
        reason!("$(find {name}): no such package is installed or near the file; state its folder: --package \
            {name}=FOLDER")
    })
}

fn installed(name: &str) -> Option<PathBuf> {
    let paths = |variable: &str| -> Vec<PathBuf> {
        env::var_os(variable).map(|all| env::split_paths(&all).collect()).unwrap_or_default()
    };
    let shared =
        paths("AMENT_PREFIX_PATH").into_iter().map(|prefix| prefix.join("share").join(name));
    let listed = paths("ROS_PACKAGE_PATH").into_iter().flat_map(|path| [path.join(name), path]);
    shared.chain(listed).find(|folder| is_package(folder, name))
}

fn above(name: &str, file: &Path) -> Option<PathBuf> {
    let file = fs::canonicalize(file).ok()?;
    for folder in file.ancestors().skip(1).take(ABOVE_MAX) {
        let beside = folder.join(name);
        for candidate in [folder, &beside] {
            if is_package(candidate, name) {
                return Some(candidate.to_owned());
            }
        }
        // A repository's folder need not have its package's name.
        let folders = fs::read_dir(folder).ok()?.flatten().take(LISTED_MAX);
        let mut folders = folders.map(|entry| entry.path()).filter(|path| path.is_dir());
        if let Some(own) = folders.find(|folder| states(folder, name)) {
            return Some(own);
        }
    }
    None
}

/// Returns true if a folder has a package's name, or its `package.xml` states it.
fn is_package(folder: &Path, name: &str) -> bool {
    let named = folder.file_name().is_some_and(|own| own == name) && folder.is_dir();
    named || states(folder, name)
}

fn states(folder: &Path, name: &str) -> bool {
    let Ok(text) = crate::input::text(&folder.join("package.xml"), 1 << 20) else { return false };
    let (start, end) = ("<name>", "</name>");
    let inside = text.split_once(start).and_then(|(_, rest)| rest.split_once(end));
    inside.is_some_and(|(own, _)| own.trim() == name)
}
