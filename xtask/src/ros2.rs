//! `cargo xtask ros2`: the node of `phihat drive --ros2` beside another DDS.

use std::fs;
use std::path::Path;

use crate::shell::cargo;
use crate::venv;

/// The other DDS, which brings its own C library.
const PACKAGES: [&str; 1] = ["cyclonedds==11.0.1"];

/// Makes what is missing, and compares what both sides count.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    if let Some(word) = arguments.first() {
        return Err(format!("ros2: {word}: nothing is known"));
    }
    let folder = root.join("target/ros2");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let python = venv::python(root, &folder.join("venv"), &PACKAGES)?;
    cargo(root, &["build", "--quiet", "-p", "phihat-cli", "--features", "ros2"])?;
    venv::script(root, &python, ("tools/ros2.py", &folder), "target/debug/phihat")
}
