//! `cargo xtask mutants`: does a test fail where the code is changed? By cargo-mutants, settings in
//! `.cargo/mutants.toml`.

use std::path::Path;
use std::process::Command;

use crate::shell::cargo;

/// Crates that are measured, and the least share of viable mutants that their tests have to kill \[%\].
const BARS: [(&str, f64); 3] =
    [("phihat", 95.0), ("phihat-kernel", 95.0), ("phihat-certificate", 90.0)];

const INSTALL: &str = "cargo-mutants is missing; `cargo install cargo-mutants --locked` installs it, and \
                       `cargo install cargo-nextest --locked` what stops at the first failure";

/// The part of the core's mutants that one commit tries, one in so many: six or seven of them.
const ROTATION: u32 = 250;

/// Least share of killed mutants in a handful \[%\]: three survivors of six fail, which chance brings once in
/// 2,000 commits where 97 % are killed.
const LEAST_OF_A_HANDFUL: f64 = 60.0;

/// Tries a handful of the core's mutants, others at every commit; installs what it needs.
pub(crate) fn rotate(root: &Path) -> Result<(), String> {
    let tools = root.join("target/tools");
    if !is_there("mutants") {
        println!("installing cargo-mutants");
        let folder = tools.display().to_string();
        let what = ["install", "cargo-mutants", "--version", "27.1.0", "--locked", "--debug"];
        cargo(root, &[&what[..], &["--quiet", "--root", &folder]].concat())?;
    }
    let shard = format!("{}/{ROTATION}", turn(root) % ROTATION);
    println!("shard {shard}");
    let chosen = ["--shard", &shard, "--sharding", "round-robin"];
    try_out(root, "phihat", &chosen, LEAST_OF_A_HANDFUL)
}

/// A number that changes with the commit.
fn turn(root: &Path) -> u32 {
    let head =
        Command::new("git").args(["rev-parse", "--short=7", "HEAD"]).current_dir(root).output();
    let text = head.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    text.ok().and_then(|text| u32::from_str_radix(text.trim().get(..7)?, 16).ok()).unwrap_or(0)
}

/// Runs the mutants of files, of a shard, or all: of the core, or of the crate that the files are in.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    if !is_there("mutants") {
        return Err(INSTALL.to_owned());
    }
    let (mut files, mut shard) = (Vec::new(), None);
    let mut words = arguments.iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--shard" => shard = Some(words.next().ok_or("--shard takes k/n, k from 0")?),
            option if option.starts_with('-') => return Err(format!("{option}: no such option")),
            file if root.join(file).is_file() => files.push(file),
            other => return Err(format!("{other}: no such file")),
        }
    }
    let of_file = |file: &&str| BARS.into_iter().find(|(name, _)| in_crate(file, name));
    let mut crates: Vec<_> = files.iter().map(of_file).collect();
    crates.dedup();
    let (name, bar) = match crates[..] {
        [] => BARS[0],
        [Some(one)] => one,
        _ => {
            return Err(
                "files of the sources of phihat, phihat-kernel or phihat-certificate".to_owned()
            );
        }
    };

    let mut chosen: Vec<&str> = files.iter().flat_map(|file| ["--file", *file]).collect();
    chosen.extend(shard.iter().flat_map(|shard| ["--shard", *shard, "--sharding", "round-robin"]));
    try_out(root, name, &chosen, bar)
}

/// Tries the chosen mutants of a crate, and holds the share that is killed against a bar.
fn try_out(root: &Path, name: &str, chosen: &[&str], bar: f64) -> Result<(), String> {
    let out = root.join("target/mutants");
    let out_text = out.display().to_string();
    std::fs::create_dir_all(&out).map_err(|e| format!("{out_text}: {e}"))?;
    let mut all = vec!["mutants", "--package", name, "--output", &out_text, "--no-shuffle"];
    all.extend(["--jobs", "1"]);
    all.extend(["--test-tool", if is_there("nextest") { "nextest" } else { "cargo" }]);
    all.extend(chosen);
    let tools = root.join("target/tools/bin");
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(tools).chain(std::env::split_paths(&path)));
    // It fails where one survives; what counts is the share.
    Command::new("cargo")
        .args(&all)
        .env("PATH", path.map_err(|e| e.to_string())?)
        .env("NEXTEST_PROFILE", "mutants")
        .current_dir(root)
        .status()
        .map_err(|e| e.to_string())?;
    judge(&out.join("mutants.out/outcomes.json"), name, bar)
}

fn in_crate(file: &str, name: &str) -> bool {
    file.starts_with(&format!("crates/{name}/src/"))
}

/// Returns true if cargo has this command.
fn is_there(command: &str) -> bool {
    let output = Command::new("cargo").args([command, "--version"]).output();
    output.is_ok_and(|output| output.status.success())
}

/// Counts the outcomes and holds the share against its bar.
fn judge(outcomes: &Path, name: &str, bar: f64) -> Result<(), String> {
    let text = std::fs::read_to_string(outcomes)
        .map_err(|e| format!("cargo-mutants left no outcome: {}: {e}", outcomes.display()))?;
    let outcomes: serde_json::Value = serde_json::from_str(&text).map_err(|e| e.to_string())?;
    let count = |kind: &str| outcomes[kind].as_u64().unwrap_or(0);
    // What runs on without end is noticed, too.
    let killed = count("caught") + count("timeout");
    let viable = killed + count("missed");
    if viable == 0 {
        return Err("no mutant was tried".to_owned());
    }
    let share = 100.0 * killed as f64 / viable as f64;
    println!(
        "{name}: {killed} of {viable} viable mutants killed, {share:.1} %, at least {bar} %; {} do not compile",
        count("unviable")
    );
    if share >= bar { Ok(()) } else { Err(format!("{name}: {share:.1} %, at least {bar} %")) }
}
