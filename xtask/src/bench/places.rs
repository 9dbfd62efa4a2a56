//! Folders of the benches, the arms that they compute, and the commands that run them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The arms that both sides compute.
pub(super) const ARMS: [&str; 4] = ["panda", "iiwa14", "ur5", "planar3r"];

/// The workspace and the folder for what this chore builds and writes.
pub(super) struct BenchPlaces {
    pub(super) root: PathBuf,
    pub(super) output: PathBuf,
}

impl BenchPlaces {
    pub(super) fn find() -> Result<Self, String> {
        let manifest =
            std::env::var("CARGO_MANIFEST_DIR").map_err(|_| "run it as `cargo xtask`")?;
        let root =
            Path::new(&manifest).parent().ok_or("xtask lies outside a workspace")?.to_owned();
        let target = std::env::var("CARGO_TARGET_DIR").unwrap_or_else(|_| "target".into());
        let output = root.join(target).join("bench");
        fs::create_dir_all(&output).map_err(|e| format!("{}: {e}", output.display()))?;
        Ok(Self { root, output })
    }

    pub(super) fn sources(&self) -> PathBuf {
        self.root.join("tools/bench")
    }
}

/// Runs a command to its end; its standard output, or what went wrong.
pub(super) fn output(command: &mut Command) -> Result<String, String> {
    let result = command
        .stderr(std::process::Stdio::inherit())
        .output()
        .map_err(|e| format!("{command:?}: {e}"))?;
    if result.status.success() {
        String::from_utf8(result.stdout).map_err(|e| format!("{command:?}: {e}"))
    } else {
        Err(format!("{command:?}: {}", result.status))
    }
}

pub(super) fn write(file: &Path, text: &str) -> Result<(), String> {
    fs::write(file, text).map_err(|e| format!("{}: {e}", file.display()))
}
