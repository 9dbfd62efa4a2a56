//! Pages beside the reports: how each is made, for those who look at them.

use std::path::Path;
use std::process::Command;

use crate::programs;

/// Folder of the pages.
pub(crate) const FOLDER: &str = "out/screenshots/pages";

/// A page in [`FOLDER`], the value of `--out`, and the words of the command.
pub(crate) type Made = (&'static str, &'static str, &'static str);

/// Pages of tables and pictures.
pub(crate) const PLAIN: [Made; 4] = [
    ("faults/report.html", "faults", "faults studies/first.toml --quick"),
    ("budget/budget.html", "budget/gains.json", "design studies/panda_design.toml --budget"),
    (
        "sweep/report.html",
        "sweep",
        "sweep studies/first.toml --vary world.payload.mass_kg=0..0.5 --runs 64 --seed 7",
    ),
    (
        "fronts/report.html",
        "fronts",
        "fronts studies/table1.toml --only time-delay,computed-torque,proposed-1 --caps 0.02,0.05 --restarts 1 \
         --per-scalar 3 --worlds 1,1,2",
    ),
];

/// Parts of pages, by the style sheet of all, in the book.
pub(crate) const SPECIMENS: &str = "docs/book/src/reference/specimens.html";

/// A comparison of every law.
pub(crate) const COMPARISON: Made = (
    "comparison/report.html",
    "comparison",
    "compare studies/table1.toml --quick --worlds exact,friction",
);

/// Makes a page where it is not there yet; its path.
pub(crate) fn made(root: &Path, (page, told, words): Made) -> Result<String, String> {
    let page = root.join(FOLDER).join(page);
    if !page.exists() {
        let program = programs::program(root, "phihat-cli/phihat")?.display().to_string();
        let told = format!("{FOLDER}/{told}");
        let words: Vec<_> = words.split(' ').chain(["--out", &told]).collect();
        // A bar that is missed (exit code 1) is an answer, with a page.
        let status = Command::new(&program).args(&words).current_dir(root).status();
        let status = status.map_err(|e| format!("{program} cannot be started: {e}"))?;
        if !matches!(status.code(), Some(0 | 1)) || !page.exists() {
            return Err(format!("{program} {}: {status}", words.join(" ")));
        }
    }
    Ok(page.display().to_string())
}
