//! The steps of the gate and the campaigns, in stages.

use std::path::Path;
use std::process::Command;

use super::measured::LOG;
use super::times;
use crate::shell::{self, cargo};
use crate::{
    attack, bindings, bless, book, browser, dist, instructions, mutants, programs, rules, tools,
    twice, web,
};

/// When a step runs, unless it is named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scope {
    /// In every run.
    Gate,
    /// With `--all`.
    All,
}

/// One check: its name, when it runs, and what it does.
#[derive(Clone, Copy, Debug)]
pub(super) struct GateStep {
    pub(super) name: &'static str,
    pub(super) scope: Scope,
    pub(super) run: fn(&Path) -> Result<(), String>,
}

/// Steps that may run side by side; the next stage begins when all have ended.
pub(super) type GateStage = Vec<GateStep>;

/// The step whose tests are measured one by one.
pub(super) const TESTS: &str = "tests";

/// The version of cargo-nextest that is installed where another one, or none, is there.
const NEXTEST: &str = "0.9.143";

const fn gate(name: &'static str, run: fn(&Path) -> Result<(), String>) -> GateStep {
    GateStep { name, scope: Scope::Gate, run }
}

const fn all(name: &'static str, run: fn(&Path) -> Result<(), String>) -> GateStep {
    GateStep { name, scope: Scope::All, run }
}

/// Every step, in the order in which they begin. Within a stage, long steps come first.
pub(super) const STAGES: [&[GateStep]; 5] = [
    &[gate("format", |root| cargo(root, &["fmt", "--all", "--check"]))],
    &[
        gate("programs, tests and their lints", programs::build),
        gate("house rules", rules::check),
        gate("tools", install),
    ],
    &[
        gate(TESTS, tests),
        gate("README and report in a browser", browser::short),
        gate("Python", bindings::python),
        gate("book", book::check),
        gate("C and C++", bindings::c),
        gate("documentation tests", documentation_tests),
        gate("attack", attack::short),
        gate("the core cannot panic or allocate", rules::core_is_bare),
        gate("instructions of a sample", instructions::check),
        gate("packages", |root| rules::packages(root, false)),
        gate("workflows", dist::workflows),
        gate("phihat for browsers compiles", web::checked),
    ],
    &[all("release build", release)],
    &[
        all("reproduction", bless::reproduced),
        all("comparison, short", bless::comparison_short),
        all("attack, longer", attack::longer),
        all("browser, every check", browser::every),
        all("screenshots", |root| crate::screenshots::run(root, &[])),
        all("exact claims", |root| crate::exact::run(root, &[])),
        all("benches, briefly", benches),
        all("every test", every_test),
        all("documentation", documentation),
        all("book, long pages", book::check_long),
        all("Python, every arm", bindings::python_all),
        all("two builds", |root| twice::run(root, Some("phihat-c"))),
        all("some mutants of the core", mutants::rotate),
        all("binary and wheel in empty folders", dist::tried),
        all("packages, each alone", |root| rules::packages(root, true)),
    ],
];

/// Every step of every stage.
pub(super) fn every() -> impl Iterator<Item = &'static GateStep> {
    STAGES.iter().flat_map(|stage| stage.iter())
}

/// Installs what later steps call: a Python environment, a browser with what drives it, mdBook with what typesets
/// its formulas, valgrind.
fn install(root: &Path) -> Result<(), String> {
    tools::from_debian(root, "valgrind", &["valgrind"])?;
    browser::tools(root)?;
    book::tool(root)?;
    tools::from_npm(root.join(book::MATH))?;
    bindings::environment(root).map(|_| ())
}

/// All tests of the gate, each in a process of its own.
fn tests(root: &Path) -> Result<(), String> {
    nextest(root, "default")
}

/// All tests, with the whole of what the gate tries a part of.
fn every_test(root: &Path) -> Result<(), String> {
    nextest(root, "campaigns")
}

/// Runs the tests that a profile of `.config/nextest.toml` chooses; each leaves its processor time.
fn nextest(root: &Path, profile: &str) -> Result<(), String> {
    let nextest = tools::from_cargo(root, "cargo-nextest", NEXTEST, &[])?;
    let file = times::tests_file(root)?;
    let _ = std::fs::remove_file(&file);
    let this = std::env::current_exe().map_err(|e| e.to_string())?;
    let status = programs::like_the_build(&mut Command::new(nextest))
        .args(["nextest", "run", "--workspace", "--lib", "--bins", "--tests", "--examples"])
        .args(["--profile", profile])
        .env(LOG, file)
        .envs((profile != "default").then_some(("PHIHAT_ALL", "1")))
        .env(runner()?, format!("{} measured", this.display()))
        .current_dir(root)
        .status()
        .map_err(|e| format!("nextest cannot be started: {e}"))?;
    if status.success() { Ok(()) } else { Err("tests fail".to_owned()) }
}

/// The variable that names what cargo and nextest run programs of this machine with.
fn runner() -> Result<String, String> {
    let output = Command::new("rustc").arg("-vV").output().map_err(|e| format!("rustc: {e}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let host = text.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or_default();
    Ok(format!("CARGO_TARGET_{}_RUNNER", host.to_uppercase().replace('-', "_")))
}

/// Benches that are programs of their own, as they run where nobody asks them for figures.
fn benches(root: &Path) -> Result<(), String> {
    let named = programs::BENCHES.iter().flat_map(|name| ["--bench", *name]);
    let mut run = Command::new("cargo");
    programs::like_the_build(&mut run).args(["test", "--workspace", "--quiet"]).args(named);
    shell::run(run.current_dir(root))
}

/// The documentation of every crate; a broken link is an error.
fn documentation(root: &Path) -> Result<(), String> {
    let mut run = Command::new("cargo");
    programs::like_the_build(&mut run).args(["doc", "--workspace", "--no-deps", "--quiet"]);
    shell::run(run.env("RUSTDOCFLAGS", "-Dwarnings").current_dir(root))
}

/// Examples and tests in the documentation.
fn documentation_tests(root: &Path) -> Result<(), String> {
    let mut run = Command::new("cargo");
    programs::like_the_build(&mut run).args(["test", "--workspace", "--doc", "--quiet"]);
    shell::run(run.current_dir(root))
}

/// Builds what a user runs, and runs the README's studies with it; nothing in it has the seam that makes the disk fail.
fn release(root: &Path) -> Result<(), String> {
    cargo(root, &["build", "--release", "--package", "phihat-cli"])?;
    let name = format!("target/release/phihat{}", std::env::consts::EXE_SUFFIX);
    let program = std::fs::read(root.join(&name)).map_err(|e| format!("{name}: {e}"))?;
    let word = b"PHIHAT_STRIKE";
    if program.windows(word.len()).any(|bytes| bytes == word) {
        return Err(format!(
            "{name} has the seam that makes the disk fail; that belongs behind debug assertions"
        ));
    }
    bless::check(root, &root.join(name))
}
