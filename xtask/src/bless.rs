//! Output of the program in the README: written by `cargo xtask bless`, checked by the tests.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::shell::{cargo, read, write};
use crate::{book, programs};

/// The README's main job.
const MAIN_JOB: [&str; 3] = ["run", "studies/panda_any.toml", "--verify"];

const OPEN: &str = "<!-- output of the main job, by cargo xtask bless -->\n```text\n";
const CLOSE: &str = "```\n";

/// The reproduction of the paper that the repository keeps.
const KEPT: &str = "docs/reproduction";
/// Folder of a fresh reproduction, to be stored or compared, in the build folder.
const FRESH: &str = "target/reproduction";

/// Runs the main job and writes its output, the paper's reproduction, and the generated parts of the book.
pub(crate) fn run(root: &Path) -> Result<(), String> {
    reproduction(root)?;
    let (before, after) = frame(root)?;
    programs::note(root)?;
    let program = programs::program(root, "phihat-cli/phihat")?;
    let printed = output(Command::new(program).args(MAIN_JOB).current_dir(root))?;
    write(&root.join("README.md"), &format!("{before}{OPEN}{printed}{CLOSE}{after}"))?;
    book::bless(root)
}

/// Reproduces the paper and keeps data, page and figures.
fn reproduction(root: &Path) -> Result<(), String> {
    let (fresh, kept) = (root.join(FRESH), root.join(KEPT));
    for old in [&fresh, &kept.join("figures")] {
        if old.exists() {
            fs::remove_dir_all(old).map_err(|e| format!("{}: {e}", old.display()))?;
        }
    }
    let build = ["run", "--quiet", "--release", "-p", "phihat-cli", "--features", "png"];
    let verb = ["--bin", "phihat", "--", "reproduce", "--out", FRESH];
    cargo(root, &[&build[..], &verb].concat())?;
    for name in ["reproduction.json", "report.html"] {
        copy(&fresh.join(name), &kept.join(name))?;
    }
    let figures = fs::read_dir(fresh.join("figures")).map_err(|e| e.to_string())?;
    for figure in figures {
        let figure = figure.map_err(|e| e.to_string())?;
        copy(&figure.path(), &kept.join("figures").join(figure.file_name()))?;
    }
    Ok(())
}

/// Measures the rivals on both arms, in full, and keeps the page. What was interrupted goes on where it was.
pub(crate) fn comparison(root: &Path) -> Result<(), String> {
    let studies = ["studies/table1.toml", "studies/table1_panda.toml"];
    cargo(root, &[&["phihat", "compare"], &studies[..]].concat())?;
    copy(&root.join("out/compare/report.html"), &root.join("docs/comparison/report.html"))
}

/// The laws of the fronts that are kept: those that were best in the comparison, and ours.
const FRONTS: &str = "effort-pid,industrial-pid,super-twisting,disturbance-observer,adrc,time-delay,indi,\
    computed-torque-integral,momentum-observer,proposed-1,proposed-positions-1,\
    proposed-positions-2,proposed-positions-designed";

/// A part of the fronts on the planar arm and on the Panda, what was chosen on one tried on the other, and
/// the pages kept. What was interrupted goes on where it was.
pub(crate) fn fronts(root: &Path) -> Result<(), String> {
    let arms = [
        ("table1", "10", "table1_panda", "report.html"),
        ("table1_panda", "5", "table1", "panda.html"),
    ];
    for (arm, restarts, other, page) in arms {
        let much = ["--restarts", restarts, "--per-scalar", "24", "--worlds", "8,8,40"];
        let [study, held_out] = [arm, other].map(|name| format!("studies/{name}.toml"));
        let verb = ["phihat", "fronts", &study, "--held-out", &held_out, "--only", FRONTS];
        let caps = ["--caps", "0.001,0.002,0.005,0.01"];
        cargo(root, &[&verb[..], &caps, &much].concat())?;
        let made = root.join(format!("out/{arm}/fronts/report.html"));
        copy(&made, &root.join("docs/fronts").join(page))?;
    }
    Ok(())
}

/// Checks that a fresh reproduction agrees with the stored one: verdicts, and numbers within their tolerance.
pub(crate) fn reproduced(root: &Path) -> Result<(), String> {
    let kept = format!("{KEPT}/reproduction.json");
    let verb = ["phihat", "reproduce", "--out", FRESH, "--against", &kept];
    cargo(root, &verb).map_err(|why| {
        format!("{why}; if the change is meant, run `cargo xtask bless` and look at the diff")
    })
}

/// Checks that the README shows the present output of a program.
pub(crate) fn check(root: &Path, program: &Path) -> Result<(), String> {
    let (before, after) = frame(root)?;
    let printed = output(Command::new(program).args(MAIN_JOB).current_dir(root))?;
    if read(&root.join("README.md"))? != format!("{before}{OPEN}{printed}{CLOSE}{after}") {
        let why = "README.md is stale: run `cargo xtask bless` and look at the diff";
        return Err(format!("{why}\nprinted now:\n{printed}"));
    }
    Ok(())
}

/// The README before and after the printed output.
fn frame(root: &Path) -> Result<(String, String), String> {
    let text = read(&root.join("README.md"))?;
    let (before, rest) = text.split_once(OPEN).ok_or("README.md has no place for the output")?;
    let (_, after) = rest.split_once(CLOSE).ok_or("README.md does not close its output")?;
    Ok((before.to_owned(), after.to_owned()))
}

/// Output of a command.
fn output(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    if let Some(folder) = to.parent() {
        fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    fs::copy(from, to).map(|_| ()).map_err(|e| format!("{}: {e}", from.display()))
}

/// Every law for a few runs in two worlds: that the comparison ends and its page is whole.
pub(crate) fn comparison_short(root: &Path) -> Result<(), String> {
    let words =
        "compare studies/table1.toml --quick --worlds exact,friction --out target/gate/compare";
    let program = programs::program(root, "phihat-cli/phihat")?;
    output(Command::new(program).args(words.split(' ')).current_dir(root)).map(|_| ())
}
