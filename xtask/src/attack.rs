//! `cargo xtask attack`: random arms and studies that try to break certificates.

use std::path::Path;

use crate::test::cargo;

/// Runs the attack, optimised; what it is told goes on to it.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    let program = ["run", "--quiet", "--release", "-p", "phihat-attack", "--"];
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    cargo(root, &[&program[..], &arguments].concat())
}
