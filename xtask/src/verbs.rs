//! `cargo xtask verbs`: what the verbs that people wait for take, and beside them those of another program.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::shell::cargo;

const USAGE: &str = "usage: cargo xtask verbs [--beside PROGRAM] [--rounds N]";
const ROUNDS: usize = 5;

/// Commands that are timed, as they are typed; OUT is a folder that is empty before the first of them.
const VERBS: [(&str, &str); 7] = [
    ("run, a first time, three joints", "run studies/first.toml --out OUT/first"),
    ("design, seven joints", "design studies/panda.toml --out OUT/gains.json"),
    ("run, a first time, seven joints", "run studies/panda.toml --out OUT/panda"),
    ("run again", "run studies/panda.toml --out OUT/panda"),
    (TO_THE_VERDICT, "run studies/panda.toml --out OUT/panda"),
    (
        "simulate with gains",
        "simulate studies/panda.toml --gains OUT/gains.json --out OUT/simulated",
    ),
    (
        "compare --quick, one law",
        "compare studies/table1.toml --quick --only pd --worlds exact --out OUT/compare",
    ),
];

/// Of this one, how long it takes until it says what the run came to.
const TO_THE_VERDICT: &str = "run again, to the verdict";
const VERDICT: &str = "within spec";

/// Runs every verb in rounds, one program after the other, and prints the least of its times.
pub(crate) fn run(root: &Path, args: &[String]) -> Result<(), String> {
    let (beside, rounds) = options(args)?;
    cargo(root, &["build", "--release", "--quiet", "--package", "phihat-cli"])?;
    let mut programs = vec![root.join("target/release/phihat")];
    programs.extend(beside);
    let mut least = vec![vec![f64::INFINITY; programs.len()]; VERBS.len()];
    for round in 1..=rounds {
        println!("round {round} of {rounds}");
        for (at, program) in programs.iter().enumerate() {
            let out = root.join("target/verbs").join(at.to_string());
            if out.exists() {
                fs::remove_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
            }
            fs::create_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
            for ((name, typed), least) in VERBS.iter().zip(&mut least) {
                let (all, to_the_verdict) = seconds(root, program, typed, &out)?;
                let own = if *name == TO_THE_VERDICT { to_the_verdict } else { all };
                least[at] = least[at].min(own);
            }
        }
    }
    let other = programs.get(1).map_or(String::new(), |_| " other [s] | ratio |".to_owned());
    println!("\n| | phihat [s] |{other}\n|---|---|{}", "---|---|".repeat(programs.len() - 1));
    for ((name, typed), least) in VERBS.iter().zip(&least) {
        let beside = least.get(1).map(|s| format!(" {s:.2} | {:.2} |", least[0] / s));
        println!("| {name}: `{typed}` | {:.2} |{}", least[0], beside.unwrap_or_default());
    }
    Ok(())
}

fn options(args: &[String]) -> Result<(Option<PathBuf>, usize), String> {
    let (mut beside, mut rounds) = (None, ROUNDS);
    let mut words = args.iter();
    while let Some(word) = words.next() {
        match (word.as_str(), words.next()) {
            ("--beside", Some(program)) => beside = Some(PathBuf::from(program)),
            ("--rounds", Some(count)) => {
                let count = count.parse().ok().filter(|count| *count > 0);
                rounds = count.ok_or(USAGE)?;
            }
            _ => return Err(USAGE.to_owned()),
        }
    }
    Ok((beside, rounds))
}

/// Time of a verb, and time until it prints its verdict \[s\]; a failure for another reason than a run
/// outside of its specification is an error.
fn seconds(root: &Path, program: &Path, typed: &str, out: &Path) -> Result<(f64, f64), String> {
    let words = typed.split(' ').map(|word| word.replace("OUT", &out.display().to_string()));
    let mut command = Command::new(program);
    command.args(words).current_dir(root).stdout(Stdio::piped()).stderr(Stdio::null());
    let lost = |why: std::io::Error| format!("{} {typed}: {why}", program.display());
    let began = Instant::now();
    let mut child = command.spawn().map_err(lost)?;
    let mut verdict = f64::INFINITY;
    for line in child.stdout.take().into_iter().flat_map(|out| BufReader::new(out).lines()) {
        if line.map_err(lost)?.contains(VERDICT) {
            verdict = verdict.min(began.elapsed().as_secs_f64());
        }
    }
    let status = child.wait().map_err(lost)?;
    match status.code() {
        Some(0 | 1) => Ok((began.elapsed().as_secs_f64(), verdict)),
        _ => Err(format!("{} {typed}: {status}", program.display())),
    }
}
