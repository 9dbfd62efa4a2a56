//! Python environments of chores, in folders of their own.

use std::fs;
use std::path::Path;

use crate::shell::command;

/// Python of an environment with these packages; made again when the list changes.
pub(crate) fn python(root: &Path, venv: &Path, packages: &[&str]) -> Result<String, String> {
    made(root, venv, &packages.join("\n"), packages)
}

/// Python of an environment with the packages of a file of requirements; made again when the file changes.
pub(crate) fn of_list(root: &Path, venv: &Path, list: &Path) -> Result<String, String> {
    let wanted = fs::read_to_string(list).map_err(|e| format!("{}: {e}", list.display()))?;
    made(root, venv, &wanted, &["-r", &list.display().to_string()])
}

/// Runs a script: `python SCRIPT FOLDER PROGRAM`, with a program of this workspace.
pub(crate) fn script(
    root: &Path,
    python: &str,
    (script, folder): (&str, &Path),
    program: &str,
) -> Result<(), String> {
    let program = root.join(format!("{program}{}", std::env::consts::EXE_SUFFIX));
    let (folder, program) = (folder.display().to_string(), program.display().to_string());
    command(root, python, &[script, &folder, &program])
}

/// Makes an environment, unless the stamp in it is what is `wanted`; `told` is what the installer is told.
fn made(root: &Path, venv: &Path, wanted: &str, told: &[&str]) -> Result<String, String> {
    let python = venv.join("bin/python").display().to_string();
    let stamp = venv.join("installed.txt");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    println!("making {} with {}", venv.display(), told.join(" "));
    command(root, "python3", &["-m", "venv", "--clear", &venv.display().to_string()])?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    command(root, &python, &[&install[..], told].concat())?;
    fs::write(&stamp, wanted).map_err(|e| format!("{}: {e}", stamp.display()))?;
    Ok(python)
}
