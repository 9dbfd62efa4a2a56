//! Pictures of every page and of the studio, to be looked at one by one.

use std::path::{Path, absolute};

use crate::shell::{command, tested};
use crate::test::{browser_tools, reports};

/// Where they are put unless somebody says otherwise.
const OUT: &str = "out/screenshots";

/// What makes the pages beside the reports: the page, in a folder of its own, what `--out` is told, and the words of the command.
const PAGES: [(&str, &str, &str); 3] = [
    ("faults/report.html", "faults", "faults studies/first.toml --quick"),
    ("budget/budget.html", "budget/gains.json", "design studies/panda_design.toml --budget"),
    (
        "comparison/report.html",
        "comparison",
        "compare studies/table1.toml --quick --worlds exact,friction",
    ),
];

/// Makes the pages that are not there yet, and pictures of all of them, of those that `args` names after the folder, and of
/// the studio.
pub(crate) fn run(root: &Path, args: &[String]) -> Result<(), String> {
    let whole = |path: &str| {
        absolute(path).map(|path| path.display().to_string()).map_err(|e| format!("{path}: {e}"))
    };
    let at = |path: &str| root.join(path).display().to_string();
    let (out, more) = match args {
        [out, more @ ..] => (whole(out)?, more),
        [] => (at(OUT), args),
    };
    let folder = browser_tools(root)?;
    let program = tested(root, "phihat-cli", "phihat")?.display().to_string();
    let mut pages = reports(root)?;
    pages.push(at("docs/reproduction/report.html"));
    for (page, told, words) in PAGES {
        let (page, told) = (at(&format!("{OUT}/pages/{page}")), format!("{OUT}/pages/{told}"));
        if !Path::new(&page).exists() {
            let words: Vec<_> = words.split(' ').chain(["--out", &told]).collect();
            command(root, &program, &words)?;
        }
        pages.push(page);
    }
    for page in more {
        pages.push(whole(page)?);
    }
    let words = ["shots.mjs", &out].into_iter().chain(pages.iter().map(String::as_str));
    command(&folder, "node", &words.collect::<Vec<_>>())?;
    let (study, gains, record) =
        (at("studies/panda.toml"), at("out/panda/gains.json"), at("out/panda"));
    command(&folder, "node", &["shots.mjs", &out, "--studio", &program, &study, &gains])?;
    command(&folder, "node", &["shots.mjs", &out, "--replay", &program, &record])?;
    println!("pictures: {out}");
    Ok(())
}
