//! Python environments of chores, in folders of their own.

use std::fs;
use std::path::Path;

use crate::shell::command;

/// Python of an environment with these packages; made again when the list changes.
pub(crate) fn python(root: &Path, venv: &Path, packages: &[&str]) -> Result<String, String> {
    let python = venv.join("bin/python").display().to_string();
    let (stamp, wanted) = (venv.join("installed.txt"), packages.join("\n"));
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    println!("making {} with {}", venv.display(), packages.join(", "));
    command(root, "python3", &["-m", "venv", "--clear", &venv.display().to_string()])?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    command(root, &python, &[&install[..], packages].concat())?;
    fs::write(&stamp, wanted).map_err(|e| format!("{}: {e}", stamp.display()))?;
    Ok(python)
}
