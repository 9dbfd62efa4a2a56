//! `cargo xtask attack`: random arms and studies that try to break certificates.

use std::path::Path;

use crate::bindings::environment;
use crate::programs;
use crate::shell::{cargo, command};

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

/// Six studies by the gate's build, in its own engine alone: half a minute of processor time.
pub(crate) fn short(root: &Path) -> Result<(), String> {
    let program = programs::program(root, "phihat-attack/phihat-attack")?.display().to_string();
    let size = ["6", "--runs", "4", "--searched", "0", "--whole-every", "4", "--fresh"];
    command(root, &program, &[&size[..], &["--out", "target/gate/attack"]].concat())
}

/// Fifty times as many, with laws that are searched for, one in twenty in Pinocchio and MuJoCo too.
pub(crate) fn longer(root: &Path) -> Result<(), String> {
    run(root, &["600", "--seed", "2", "--fresh"].map(String::from))
}
