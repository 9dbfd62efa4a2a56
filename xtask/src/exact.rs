//! Linear claims of random laws: edges found by the kernel, decided again by FLINT.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::shell::command;
use crate::venv;

/// Exact rational matrices and enclosed roots; grids.
const PACKAGES: [&str; 2] = ["python-flint==0.9.0", "numpy==2.2.6"];

/// Laws that are tried where nobody says how many.
const COUNT: &str = "1000";

/// `cargo xtask exact [LAWS]`: the edges of each law's claims, and whether both sides of each are what they should be.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    let folder = root.join("target/exact");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let python = venv::python(root, &folder.join("venv"), &PACKAGES)?;
    let count = arguments.first().map_or(COUNT, String::as_str);
    let edges = folder.join("edges.jsonl");
    let file = fs::File::create(&edges).map_err(|e| format!("{}: {e}", edges.display()))?;
    let build = ["run", "--quiet", "--release", "-p", "phihat-kernel", "--example", "edges", "--"];
    let mut cargo = Command::new("cargo");
    let written = cargo.args(build).arg(count).stdout(file).current_dir(root).status();
    if !written.map_err(|e| format!("cargo: {e}"))?.success() {
        return Err("the kernel's edges were not written".to_owned());
    }
    let script = "crates/phihat-kernel/tests/edges.py";
    command(root, &python, &[script, &edges.display().to_string()])
}
