//! Programs of others that the checks need: where they are kept, and how each is installed where it is missing.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{cargo, command};

/// The folder of installed tools, shared by all clones of one user: `$PHIHAT_TOOLS`, else `phihat` in the user's cache.
pub(crate) fn folder() -> Result<PathBuf, String> {
    let of =
        |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let cache = || of("XDG_CACHE_HOME").or_else(|| Some(of("HOME")?.join(".cache")));
    let folder = of("PHIHAT_TOOLS").or_else(|| Some(cache()?.join("phihat")));
    let folder = folder.ok_or("no place for tools: set PHIHAT_TOOLS to a folder")?;
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    Ok(folder)
}

/// A lock on the folder of tools, so that two clones do not install one tool at the same time; it ends when
/// it is dropped.
pub(crate) fn lock() -> Result<File, String> {
    let path = folder()?.join("lock");
    let failed = |e: std::io::Error| format!("{}: {e}", path.display());
    let file = File::create(&path).map_err(failed)?;
    file.lock().map_err(failed)?;
    Ok(file)
}

/// A program of cargo's registry in one version: the one on the path if it has that version, else one of our
/// own, built from source.
pub(crate) fn from_cargo(
    root: &Path,
    name: &str,
    version: &str,
    more: &[&str],
) -> Result<PathBuf, String> {
    let has_version = |program: &Path| {
        let output = Command::new(program).arg("--version").output();
        output.is_ok_and(|o| String::from_utf8_lossy(&o.stdout).contains(version))
    };
    let on_path = PathBuf::from(name);
    if has_version(&on_path) {
        return Ok(on_path);
    }
    let place = folder()?.join(format!("{name}-{version}"));
    let own = place.join("bin").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    let _lock = lock()?;
    if !has_version(&own) {
        println!("installing {name} {version} into {}", place.display());
        let at = place.display().to_string();
        let line = [
            "install",
            name,
            "--version",
            version,
            "--locked",
            "--debug",
            "--quiet",
            "--root",
            &at,
        ];
        cargo(root, &[&line[..], more].concat())?;
    }
    Ok(own)
}

/// Installs packages of Debian unless a program of theirs answers.
pub(crate) fn from_debian(root: &Path, program: &str, packages: &[&str]) -> Result<(), String> {
    if Command::new(program).arg("--version").output().is_ok() {
        return Ok(());
    }
    let _lock = lock()?;
    println!("installing {}", packages.join(" "));
    command(root, "apt-get", &["update", "-qq"])?;
    command(root, "apt-get", &[&["install", "-y", "-qq"][..], packages].concat()).map_err(|why| {
        format!("{why}; {program} is needed: install {} by hand", packages.join(" "))
    })
}

/// The packages that a folder's `package-lock.json` names, installed beside it where they are missing or older;
/// the folder.
pub(crate) fn from_npm(folder: PathBuf) -> Result<PathBuf, String> {
    let changed = |name: &str| folder.join(name).metadata().and_then(|file| file.modified()).ok();
    // npm leaves this list when it has installed the other.
    let (list, installed) =
        (changed("package-lock.json"), changed("node_modules/.package-lock.json"));
    if installed.is_none() || installed < list {
        command(&folder, "npm", &["ci", "--no-audit", "--no-fund", "--loglevel=error"])?;
    }
    Ok(folder)
}
