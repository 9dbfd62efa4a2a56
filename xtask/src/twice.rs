//! `cargo xtask twice`: do two builds of one commit, in two folders, give the same bytes?

use std::path::Path;
use std::process::Command;

use sha2::{Digest, Sha256};

/// A package, and what its release build leaves in `target/release`.
const BUILT: [(&str, &str); 2] = [("phihat-c", "libphihat_c.a"), ("phihat-cli", "phihat")];

/// Builds what is committed twice, each time from nothing, and compares: all, or the package that is named.
pub(crate) fn run(root: &Path, package: Option<&str>) -> Result<(), String> {
    let chosen: Vec<_> =
        BUILT.iter().filter(|(name, _)| package.is_none_or(|p| p == *name)).collect();
    if chosen.is_empty() {
        return Err(format!("packages: {}", BUILT.map(|(name, _)| name).join(" ")));
    }
    for (package, file) in chosen {
        let first = build(root, "a", package, file)?;
        let second = build(root, "a-longer-name/b", package, file)?;
        println!("{package}: {first} {file}");
        if first != second {
            return Err(format!(
                "{package}: a second build gives {second}, the first gave {first}"
            ));
        }
    }
    Ok(())
}

/// The SHA-256 of what a build of the commit in a folder of its own leaves there.
fn build(root: &Path, folder: &str, package: &str, file: &str) -> Result<String, String> {
    let folder = root.join("target/twice").join(folder);
    let told = |e: std::io::Error| format!("{}: {e}", folder.display());
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(told)?;
    }
    std::fs::create_dir_all(&folder).map_err(told)?;
    let archive = Command::new("git")
        .args(["archive", "--format=tar", "HEAD"])
        .current_dir(root)
        .output()
        .map_err(|e| format!("git cannot be started: {e}"))?;
    let packed = folder.join("source.tar");
    std::fs::write(&packed, archive.stdout).map_err(told)?;
    crate::shell::command(&folder, "tar", &["-xf", "source.tar"])?;
    let line = ["build", "--release", "--quiet", "--package", package, "--target-dir", "target"];
    crate::shell::cargo(&folder, &line)?;
    let bytes = std::fs::read(folder.join("target/release").join(file)).map_err(told)?;
    std::fs::remove_dir_all(&folder).map_err(told)?;
    Ok(Sha256::digest(bytes).iter().fold(String::new(), |hex, byte| hex + &format!("{byte:02x}")))
}
