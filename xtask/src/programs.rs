//! All programs of the workspace, built once, and where they are.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::shell::{gate_folder, read, write};

/// The file with the place of each program, by package and name.
const PLACES: &str = "programs.json";

/// Benches that are programs of their own and count or time what users wait for.
pub(crate) const BENCHES: [&str; 6] =
    ["update", "instructions", "soak", "dynamics", "tube", "closed_loop"];

/// Builds libraries, programs, examples, tests and benches of the workspace in one go, with one profile and
/// the features that a user has by default, and notes where the programs are.
pub(crate) fn build(root: &Path) -> Result<(), String> {
    if Command::new("clippy-driver").arg("--version").output().is_err() {
        return Err("clippy-driver is missing: rustup component add clippy".to_owned());
    }
    let mut names = vec!["--tests"];
    names.extend(BENCHES.iter().flat_map(|name| ["--bench", *name]));
    noted(root, &names)
}

/// The same without tests and benches, for a chore that needs a program.
pub(crate) fn note(root: &Path) -> Result<(), String> {
    noted(root, &[])
}

fn noted(root: &Path, more: &[&str]) -> Result<(), String> {
    let output = like_the_build(&mut Command::new("cargo"))
        .args(["build", "--workspace", "--lib", "--bins", "--examples"])
        .args(more)
        .args(["--keep-going", "--quiet", "--message-format=json-render-diagnostics"])
        .current_dir(root)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo cannot be started: {e}"))?;
    if !output.status.success() {
        return Err(format!("the programs do not build: {}", output.status));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let places: BTreeMap<_, _> = text.lines().filter_map(place).collect();
    let text = serde_json::to_string_pretty(&places).map_err(|e| e.to_string())?;
    write(&gate_folder(root)?.join(PLACES), &text)
}

/// Makes a cargo command compile as [`build`] does, and so use what it has compiled: crates of the workspace
/// by clippy's driver, which is rustc with the lints, a warning being an error. A pass of clippy by itself
/// would check every crate a second time, which takes as long as a third of the build. The driver leaves out
/// some optimisations before LLVM's; results are the same to the bit.
pub(crate) fn like_the_build(command: &mut Command) -> &mut Command {
    // What `cargo clippy -- -Dwarnings` sets.
    command
        .env("RUSTC_WORKSPACE_WRAPPER", "clippy-driver")
        .env("CLIPPY_ARGS", "-Dwarnings__CLIPPY_HACKERY__")
        .env("CARGO_INCREMENTAL", "0")
}

/// A program, an example or a C library that the last build left: `package/name`.
pub(crate) fn program(root: &Path, name: &str) -> Result<PathBuf, String> {
    let text = read(&gate_folder(root)?.join(PLACES))?;
    let places: BTreeMap<String, PathBuf> =
        serde_json::from_str(&text).map_err(|e| e.to_string())?;
    places.get(name).cloned().ok_or_else(|| format!("the build left no {name}"))
}

/// The name and the place of what a message of cargo's is about: an executable, or a library for other languages.
fn place(line: &str) -> Option<(String, PathBuf)> {
    let message: Value = serde_json::from_str(line).ok()?;
    if message["profile"]["test"] == true {
        return None;
    }
    let package = Path::new(message["manifest_path"].as_str()?).parent()?.file_name()?.to_str()?;
    let target = message["target"]["name"].as_str()?;
    let files = message["filenames"].as_array()?.iter().filter_map(Value::as_str);
    let shared = |file: &&str| [".so", ".dylib", ".dll"].iter().any(|end| file.ends_with(end));
    let procedural = message["target"]["kind"][0] == "proc-macro";
    let library = files.clone().find(shared).filter(|_| !procedural);
    let file = message["executable"].as_str().or(library)?;
    Some((format!("{package}/{target}"), PathBuf::from(file)))
}

#[cfg(test)]
mod tests {
    use super::place;
    use std::path::PathBuf;

    #[test]
    fn programs_and_libraries_for_other_languages_are_noted() {
        let line = |kind: &str, executable: &str, file: &str| {
            format!(
                r#"{{"reason":"compiler-artifact","manifest_path":"/w/crates/one/Cargo.toml",
                "target":{{"name":"t","kind":["{kind}"]}},
                "executable":{executable},"filenames":["{file}"]}}"#
            )
        };
        let noted = |file: &str| Some(("one/t".to_owned(), PathBuf::from(file)));
        assert_eq!(place(&line("bin", r#""/w/t""#, "/w/t")), noted("/w/t"));
        assert_eq!(place(&line("cdylib", "null", "/w/libt.so")), noted("/w/libt.so"));
        assert_eq!(place(&line("proc-macro", "null", "/w/libt.so")), None);
        assert_eq!(place(&line("lib", "null", "/w/libt.rlib")), None);
        assert_eq!(place("   Compiling t"), None);
    }
}
