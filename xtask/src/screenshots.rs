//! Pictures of every page and of the studio, to be looked at one by one.

use std::path::{Path, absolute};

use crate::pages::{COMPARISON, PLAIN, SPECIMENS, made};
use crate::shell::command;
use crate::{browser, programs};

/// Default folder of the pictures.
const OUT: &str = "out/screenshots";

/// Makes the pages that are not there yet, and pictures of all of them, of those that `args` names after the
/// folder, and of the studio.
pub(crate) fn run(root: &Path, args: &[String]) -> Result<(), String> {
    let whole = |path: &str| {
        absolute(path).map(|path| path.display().to_string()).map_err(|e| format!("{path}: {e}"))
    };
    let at = |path: &str| root.join(path).display().to_string();
    let (out, more) = match args {
        [out, more @ ..] => (whole(out)?, more),
        [] => (at(OUT), args),
    };
    let folder = browser::tools(root)?;
    let program = programs::program(root, "phihat-cli/phihat")?.display().to_string();
    let mut pages = browser::reports(root)?;
    pages.extend(["docs/reproduction/report.html", SPECIMENS].map(at));
    for page in PLAIN.into_iter().chain([COMPARISON]) {
        pages.push(made(root, page)?);
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
