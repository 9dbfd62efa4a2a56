//! Where the workspace is, and programs run in it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The workspace's root folder.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map_or_else(PathBuf::new, Path::to_owned)
}

/// Runs a program in a folder; its output goes to the terminal.
pub(crate) fn command(folder: &Path, program: &str, args: &[&str]) -> Result<(), String> {
    let status = Command::new(program)
        .args(args)
        .current_dir(folder)
        .status()
        .map_err(|e| format!("{program} cannot be started: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("{program} {}: {status}", args.join(" "))) }
}

pub(crate) fn cargo(root: &Path, args: &[&str]) -> Result<(), String> {
    command(root, "cargo", args)
}

/// All that can be built in: one set of features for everything that is checked, so that nothing is compiled for each of them.
pub(crate) const EVERYTHING: [&str; 2] =
    ["--features", "phihat-cli/mcap,phihat-cli/png,phihat-cli/studio"];

/// A program of the workspace as its tests have it, with all features: an example of a package, or a binary.
pub(crate) fn tested(root: &Path, package: &str, name: &str) -> Result<PathBuf, String> {
    let output = Command::new("cargo")
        .args(["build", "--workspace", "--profile", "test", "--examples", "--bins"])
        .args(EVERYTHING)
        .arg("--message-format=json-render-diagnostics")
        .current_dir(root)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo cannot be started: {e}"))?;
    if !output.status.success() {
        return Err(format!("{name} of {package} does not build"));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let found = text.lines().find_map(|line| {
        let told: serde_json::Value = serde_json::from_str(line).ok()?;
        let folder = Path::new(told["manifest_path"].as_str()?).parent()?;
        let is_it = folder.ends_with(package) && told["target"]["name"] == name;
        told["executable"].as_str().filter(|_| is_it).map(PathBuf::from)
    });
    found.ok_or_else(|| format!("cargo built no {name} of {package}"))
}

/// The text of a file.
pub(crate) fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// Writes a file, its folder included.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), String> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}
