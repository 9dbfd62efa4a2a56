//! `cargo xtask ray`: a sweep on a cluster of Ray on this machine, whose workers and nodes are killed half-way.

use std::path::Path;

use crate::bindings;
use crate::shell::cargo;
use crate::venv;

/// The cluster, and what builds the package for it.
const PACKAGES: [&str; 3] = ["maturin==1.16.0", "numpy==2.4.6", "ray[default]==2.60.0"];

/// Makes what is missing, and sweeps.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    if let Some(word) = arguments.first() {
        return Err(format!("ray: {word}: nothing is known"));
    }
    let folder = root.join("target/ray");
    let python = venv::python(root, &folder.join("venv"), &PACKAGES)?;
    cargo(root, &["build", "--quiet", "--release", "-p", "phihat-cli"])?;
    bindings::install(root, &python)?;
    venv::script(root, &python, ("tools/ray_cluster.py", &folder), "target/release/phihat")
}
