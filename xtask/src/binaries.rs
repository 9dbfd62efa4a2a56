//! Test binaries side by side: cargo runs one after the other, and the last test of each leaves cores idle.

use std::collections::VecDeque;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::shell::EVERYTHING;

/// Packages whose tests take longest: they begin first.
const LONG: [&str; 4] = ["phihat-cli", "phihat-design", "phihat-certificate", "phihat-attack"];

/// A test binary, and the folder of its package, which it runs in.
#[derive(Debug, PartialEq)]
struct Binary {
    target: String,
    package: PathBuf,
    file: PathBuf,
}

/// Builds all tests of the workspace, benches and examples, and runs as many binaries at a time as there are cores.
pub(crate) fn run(root: &Path) -> Result<(), String> {
    let began = Instant::now();
    let told = ["test", "--workspace", "--all-targets", "--no-run"];
    let built = Command::new("cargo")
        .args(told)
        .args(EVERYTHING)
        .arg("--message-format=json-render-diagnostics")
        .current_dir(root)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo cannot be started: {e}"))?;
    if !built.status.success() {
        return Err(format!("cargo {}: {}", told.join(" "), built.status));
    }
    let mut all: Vec<Binary> =
        String::from_utf8_lossy(&built.stdout).lines().filter_map(binary).collect();
    all.sort_by_key(|one| {
        LONG.iter().position(|long| one.package.ends_with(long)).unwrap_or(LONG.len())
    });
    let count = all.len();
    println!("{count} test binaries built in {:.0} s", began.elapsed().as_secs_f64());
    let failed = side_by_side(all)?;
    if failed.is_empty() {
        println!("{count} test binaries ok");
        return Ok(());
    }
    Err(format!("{} of {count} test binaries failed: {}", failed.len(), failed.join(", ")))
}

/// What a line of cargo's says of a test binary, if it is about one.
fn binary(line: &str) -> Option<Binary> {
    let told: Value = serde_json::from_str(line).ok()?;
    if told["reason"] != "compiler-artifact" || told["profile"]["test"] != true {
        return None;
    }
    Some(Binary {
        target: told["target"]["name"].as_str()?.to_owned(),
        package: Path::new(told["manifest_path"].as_str()?).parent()?.to_owned(),
        file: told["executable"].as_str()?.into(),
    })
}

/// Names of those that failed.
fn side_by_side(all: Vec<Binary>) -> Result<Vec<String>, String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (todo, failed) = (Mutex::new(VecDeque::from(all)), Mutex::new(Vec::new()));
    let held = "a thread ended while it told what it found";
    let work = || -> Result<(), String> {
        loop {
            let next = todo.lock().map_err(|_| held)?.pop_front();
            let Some(one) = next else { return Ok(()) };
            let began = Instant::now();
            let done = Command::new(&one.file)
                .current_dir(&one.package)
                .env("CARGO_MANIFEST_DIR", &one.package)
                .output()
                .map_err(|e| format!("{}: {e}", one.file.display()))?;
            let mut failed = failed.lock().map_err(|_| held)?;
            if !done.status.success() {
                failed.push(one.target.clone());
            }
            tell(&one, &done, began.elapsed()).map_err(|e| e.to_string())?;
        }
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| thread.join().unwrap_or(Err(held.to_owned())))
    })?;
    failed.into_inner().map_err(|_| held.to_owned())
}

/// What a binary printed, whole, and how long it took.
fn tell(one: &Binary, done: &Output, took: Duration) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let name = one.package.file_name().unwrap_or_default().to_string_lossy();
    writeln!(out, "\n   {} of {name}, {:.1} s", one.target, took.as_secs_f64())?;
    out.write_all(&done.stdout)?;
    out.write_all(&done.stderr)
}

#[cfg(test)]
mod tests {
    use super::{Binary, binary, side_by_side};

    #[test]
    fn of_what_cargo_says_test_binaries_are_taken() {
        let line = |test: bool, executable: &str| {
            format!(
                r#"{{"reason":"compiler-artifact","manifest_path":"/w/a/Cargo.toml","target":{{"name":"t"}},
                "profile":{{"test":{test}}},"executable":{executable}}}"#
            )
        };
        let own = Binary { target: "t".into(), package: "/w/a".into(), file: "/w/t-1".into() };
        assert_eq!(binary(&line(true, r#""/w/t-1""#)), Some(own));
        assert_eq!(binary(&line(false, r#""/w/t-1""#)), None);
        assert_eq!(binary(&line(true, "null")), None);
        assert_eq!(binary("   Compiling"), None);
    }

    #[test]
    fn one_that_fails_is_named_and_one_that_is_not_there_is_an_error() {
        let program =
            |file: &str| Binary { target: file.to_owned(), package: "/".into(), file: file.into() };
        let named = side_by_side(vec![program("true"), program("false"), program("true")]);
        assert_eq!(named, Ok(vec!["false".to_owned()]));
        assert!(side_by_side(vec![program("/nowhere/at/all")]).is_err());
    }
}
