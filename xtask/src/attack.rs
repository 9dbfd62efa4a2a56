//! `cargo xtask attack`: random arms and studies that try to break certificates.

use std::path::Path;

use crate::bindings::environment;
use crate::shell::cargo;

/// Runs the attack, optimised; what it is told goes on to it. One study in twenty is run by Pinocchio and MuJoCo too,
/// unless it is told `--alone`.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    let mut all =
        ["run", "--quiet", "--release", "-p", "phihat-attack", "--"].map(String::from).to_vec();
    all.extend(arguments.iter().filter(|word| *word != "--alone").cloned());
    if arguments.iter().all(|word| word != "--alone") {
        all.extend(["--python".to_owned(), environment(root)?]);
    }
    cargo(root, &all.iter().map(String::as_str).collect::<Vec<_>>())
}
