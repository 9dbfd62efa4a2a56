//! `cargo xtask dist`: the parts of a release, in `target/dist`; and the check that each part works where
//! nothing else is.
//!
//! | file | what it is |
//! |---|---|
//! | `phihat-VERSION-TARGET.tar.gz` | the command, stripped, for the baseline processor of the architecture, with licences |
//! | `phihat-VERSION-*.whl` | the package of Python, for every Python from 3.10 on, with the same instructions |
//! | `*.crate` | the source of each published crate |
//! | `SHA256SUMS` | their hashes |

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use sha2::{Digest, Sha256};

use crate::shell::{command, read, run as run_command, write};
use crate::{book, rules, tools, venv};

const OUT: &str = "target/dist";
/// Builds for other machines than this one have a folder of their own: they share nothing with the others.
const BUILD: &str = "target/dist-build";

/// Package that makes the wheel.
const MATURIN: [&str; 1] = ["maturin==1.16.0"];

/// Package that checks the workflow files, and the citation file, by the schemas of their makers.
const LINT: [&str; 1] = ["check-jsonschema==0.39.0"];

/// Examples of Python that need nothing but what the wheel declares.
const EXAMPLES: [&str; 4] = ["01_controller", "02_supervisor", "04_design", "05_simulate"];

/// Makes binary, wheel and source packages, and their hashes.
pub(crate) fn run(root: &Path) -> Result<(), String> {
    let out = root.join(OUT);
    if out.exists() {
        fs::remove_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
    }
    fs::create_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
    binary(root, &out)?;
    wheel(root, &out)?;
    sources(root, &out)?;
    sums(&out)
}

/// Without the flags of `.cargo/config.toml`, which are for the processor at hand.
fn for_all(command: &mut Command, root: &Path) -> Result<(), String> {
    run_command(
        command
            .env("RUSTFLAGS", "")
            .env("CARGO_TARGET_DIR", root.join(BUILD))
            .env("CARGO_PROFILE_RELEASE_STRIP", "symbols"),
    )
}

fn binary(root: &Path, out: &Path) -> Result<(), String> {
    for_all(
        Command::new("cargo")
            .args(["build", "--release", "--package", "phihat-cli", "--quiet"])
            .current_dir(root),
        root,
    )?;
    let name = format!("phihat-{}-{}", version(root)?, host()?);
    let folder = root.join(BUILD).join(&name);
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let program = format!("phihat{}", std::env::consts::EXE_SUFFIX);
    let built = root.join(BUILD).join("release").join(&program);
    let documents = ["README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT"];
    let files = documents.map(|file| (root.join(file), file.to_owned()));
    for (from, to) in files.into_iter().chain([(built, program)]) {
        fs::copy(&from, folder.join(to)).map_err(|e| format!("{}: {e}", from.display()))?;
    }
    let archive = out.join(format!("{name}.tar.gz")).display().to_string();
    command(&root.join(BUILD), "tar", &["-czf", &archive, &name])
}

fn wheel(root: &Path, out: &Path) -> Result<(), String> {
    let python = venv::python(root, &root.join("target/maturin"), &MATURIN)?;
    println!("building the wheel of crates/phihat-py");
    for_all(
        Command::new(&python)
            .args(["-m", "maturin", "build", "--release", "--strip", "--quiet", "--interpreter"])
            .arg(&python)
            .arg("--out")
            .arg(out)
            .current_dir(root.join("crates/phihat-py")),
        root,
    )
}

fn sources(root: &Path, out: &Path) -> Result<(), String> {
    rules::packages(root, false)?;
    let packed = root.join("target/package");
    for file in files(&packed, "crate")? {
        let to = out.join(file.file_name().unwrap_or_default());
        fs::copy(&file, to).map_err(|e| format!("{}: {e}", file.display()))?;
    }
    Ok(())
}

fn sums(out: &Path) -> Result<(), String> {
    let mut text = String::new();
    let mut all: Vec<PathBuf> = Vec::new();
    for ending in ["gz", "whl", "crate"] {
        all.extend(files(out, ending)?);
    }
    for file in all {
        let bytes = fs::read(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        let hash =
            Sha256::digest(&bytes).iter().fold(String::new(), |hex, b| hex + &format!("{b:02x}"));
        let name = file.file_name().unwrap_or_default().display().to_string();
        println!("{hash}  {:>9.1} kB  {name}", bytes.len() as f64 / 1e3);
        text += &(hash + "  " + &name + "\n");
    }
    write(&out.join("SHA256SUMS"), &text)
}

/// Makes all parts and tries each where nothing else is: the command runs the tutorial from its archive, the
/// wheel runs examples in an environment that has only what it declares. The source packages are built alone
/// by a step of their own.
pub(crate) fn tried(root: &Path) -> Result<(), String> {
    run(root)?;
    let out = root.join(OUT);
    let empty = root.join("target/dist-tried");
    if empty.exists() {
        fs::remove_dir_all(&empty).map_err(|e| format!("{}: {e}", empty.display()))?;
    }
    fs::create_dir_all(&empty).map_err(|e| format!("{}: {e}", empty.display()))?;
    let archive = files(&out, "gz")?.pop().ok_or("there is no archive")?;
    let only = ["-xzf", &archive.display().to_string(), "--strip-components", "1"];
    command(&empty, "tar", &only)?;
    let program = empty.join(format!("phihat{}", std::env::consts::EXE_SUFFIX));
    book::tutorial(root, &program)?;
    // valgrind knows no instruction that is newer than AVX2: it ends a program that has one.
    let text = program.display().to_string();
    let study = root.join("studies/first.toml").display().to_string();
    let tool = ["--tool=none", "--quiet", &text, "check", &study];
    command(&empty, "valgrind", &tool)?;

    let wheel = files(&out, "whl")?.pop().ok_or("there is no wheel")?.display().to_string();
    let python = venv::python(root, &empty.join("python"), &[&wheel])?;
    for example in EXAMPLES {
        let path = root.join(format!("examples/python/{example}.py")).display().to_string();
        command(&empty, &python, &[&path])?;
    }
    Ok(())
}

/// Checks that the workflow files and the citation file satisfy their schemas.
pub(crate) fn workflows(root: &Path) -> Result<(), String> {
    let python = venv::python(root, &tools::folder()?.join("workflows"), &LINT)?;
    let all: Vec<String> = files(&root.join(".github/workflows"), "yml")?
        .into_iter()
        .map(|file| file.display().to_string())
        .collect();
    let schema = ["-m", "check_jsonschema", "--builtin-schema"];
    let workflows = ["vendor.github-workflows"].into_iter().chain(all.iter().map(String::as_str));
    command(root, &python, &schema.into_iter().chain(workflows).collect::<Vec<_>>())?;
    let citation = ["vendor.citation-file-format", "CITATION.cff"];
    command(root, &python, &[&schema[..], &citation].concat())
}

/// Files of a folder with an ending, sorted.
fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let paths = entries.filter_map(|entry| entry.ok().map(|e| e.path()));
    let mut found: Vec<_> = paths.filter(|p| p.extension() == Some(OsStr::new(ending))).collect();
    found.sort();
    Ok(found)
}

/// The version of every crate.
fn version(root: &Path) -> Result<String, String> {
    let text = read(&root.join("Cargo.toml"))?;
    let line = text.lines().find_map(|line| line.strip_prefix("version = \""));
    line.and_then(|rest| rest.split('"').next()).map(str::to_owned).ok_or("no version".to_owned())
}

/// The machine that programs are built for where nothing else is asked for.
fn host() -> Result<String, String> {
    let output = Command::new("rustc").arg("-vV").output().map_err(|e| format!("rustc: {e}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or("rustc names no host".to_owned())
}
