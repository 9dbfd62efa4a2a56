//! Pages and the studio in headless Chromium.

use std::path::{Path, PathBuf};

use crate::shell::command;
use crate::{bless, pages, programs, tools as installed};

/// The browser, installed where it is missing.
pub(crate) fn chromium(root: &Path) -> Result<(), String> {
    installed::from_debian(root, "chromium", &["chromium", "fonts-dejavu-core"])
}

/// The folder of the checks, with what drives the browser; both are installed where they are missing.
pub(crate) fn tools(root: &Path) -> Result<PathBuf, String> {
    chromium(root)?;
    installed::from_npm(root.join("crates/phihat-report/tests/browser"))
}

/// The README's main job, whose output the README shows; then a short look at its report, at a page of each
/// other kind, and at the studio.
pub(crate) fn short(root: &Path) -> Result<(), String> {
    let program = programs::program(root, "phihat-cli/phihat")?;
    bless::check(root, &program)?;
    let folder = tools(root)?;
    let look =
        |words: &[&str]| command(&folder, "node", &[&["check.mjs", "--short"], words].concat());
    look(&[&root.join("out/panda_any/report.html").display().to_string()])?;
    let [made_up, hostile] =
        ["reproduction-page", "hostile"].map(|name| root.join("target").join(name));
    example(root, "phihat-paper/made_up", &[&made_up.display().to_string()])?;
    look(&["--reproduction", &made_up.join("page.html").display().to_string()])?;
    example(root, "phihat-report/demo", &[&hostile.display().to_string(), "hostile"])?;
    look(&["--hostile", &html(&hostile)?[0]])?;
    look(&["--comparison", &comparison(root)?])?;
    let _ = std::fs::remove_dir_all(root.join(pages::FOLDER));
    look(&["--plain", &pages::made(root, pages::PLAIN[2])?])?;
    let study = root.join("studies/first.toml").display().to_string();
    command(&folder, "node", &["studio.mjs", "--short", &program.display().to_string(), &study])
}

/// Runs an example of the gate's build: `package/name`.
fn example(root: &Path, name: &str, words: &[&str]) -> Result<(), String> {
    command(root, &programs::program(root, name)?.display().to_string(), words)
}

/// The pages of a folder, sorted.
fn html(folder: &Path) -> Result<Vec<String>, String> {
    let mut pages: Vec<String> = std::fs::read_dir(folder)
        .map_err(|e| format!("{}: {e}", folder.display()))?
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "html"))
        .map(|path| path.display().to_string())
        .collect();
    pages.sort();
    if pages.is_empty() { Err(format!("{}: no page", folder.display())) } else { Ok(pages) }
}

/// The page of a comparison of three laws in two worlds.
fn comparison(root: &Path) -> Result<String, String> {
    let small = "compare studies/table1.toml --quick --only pd,computed-torque,proposed-2 --worlds exact,friction";
    let out = root.join("out/browser-compare").display().to_string();
    let words: Vec<_> = small.split(' ').chain(["--out", &out]).collect();
    command(root, &programs::program(root, "phihat-cli/phihat")?.display().to_string(), &words)?;
    Ok(format!("{out}/report.html"))
}

/// The reports of the README and of two more studies, with traces as texts alongside, which the checks in a
/// browser read; made where they are not there yet.
pub(crate) fn reports(root: &Path) -> Result<Vec<String>, String> {
    let mut pages = Vec::new();
    for study in ["panda", "first", "panda_design"] {
        let record = root.join("out").join(study);
        let page = record.join("report.html");
        if !page.exists() || !record.join("trace.csv").exists() {
            let study = format!("studies/{study}.toml");
            let program = programs::program(root, "phihat-cli/phihat")?.display().to_string();
            command(root, &program, &["run", &study, "--csv", "--quiet"])?;
        }
        pages.push(page.display().to_string());
    }
    Ok(pages)
}

/// Every page and the studio, every check.
pub(crate) fn every(root: &Path) -> Result<(), String> {
    let folder = tools(root)?;
    let pages = reports(root)?;
    command(&folder, "node", &["check.mjs", &pages[0], &pages[1], &pages[2]])?;
    // Made up, with everything that the page can show; and the paper's, where it was made.
    let made_up = root.join("target/reproduction-page").display().to_string();
    example(root, "phihat-paper/made_up", &[&made_up])?;
    let mut arguments = vec!["check.mjs".to_owned(), "--reproduction".to_owned()];
    arguments.push(format!("{made_up}/page.html"));
    let fresh = root.join("target/reproduction/report.html");
    arguments.extend(fresh.exists().then(|| fresh.display().to_string()));
    let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
    command(&folder, "node", &arguments)?;
    command(&folder, "node", &["check.mjs", "--comparison", &comparison(root)?])?;
    // Made anew: what an earlier program left there says nothing of this one.
    let _ = std::fs::remove_dir_all(root.join(pages::FOLDER));
    let plain = pages::PLAIN.into_iter().map(|page| pages::made(root, page));
    let plain = plain.collect::<Result<Vec<_>, _>>()?;
    let specimens = root.join(pages::SPECIMENS).display().to_string();
    let words = ["check.mjs", "--plain", &specimens];
    let words = words.into_iter().chain(plain.iter().map(String::as_str));
    command(&folder, "node", &words.collect::<Vec<_>>())?;
    // Without what an earlier run left there.
    let hostile = root.join("target/hostile");
    let _ = std::fs::remove_dir_all(&hostile);
    let hostile = hostile.display().to_string();
    example(root, "phihat-report/demo", &[&hostile, "hostile"])?;
    let pages = html(Path::new(&hostile))?;
    let mut arguments = vec!["check.mjs", "--hostile"];
    arguments.extend(pages.iter().map(String::as_str));
    command(&folder, "node", &arguments)?;
    studio(root, &folder)
}

/// `phihat studio` in a browser: the Panda under the gains of the main job, a study whose gains are stated, a
/// record, an arm with a mesh, and a log.
fn studio(root: &Path, folder: &Path) -> Result<(), String> {
    let program = programs::program(root, "phihat-cli/phihat")?.display().to_string();
    let at = |path: &str| root.join(path).display().to_string();
    let (study, gains) = (at("studies/panda_any.toml"), at("out/panda_any/gains.json"));
    command(folder, "node", &["studio.mjs", &program, &study, &gains])?;
    command(folder, "node", &["studio.mjs", &program, &at("studies/first.toml")])?;
    command(folder, "node", &["studio.mjs", &program, "--replay", &at("out/panda")])?;
    command(folder, "node", &["studio.mjs", &program, "--mesh"])?;
    // A log, played on the study that it is of.
    let (study, out) = (at("studies/first.toml"), at("out/browser-log"));
    let log = format!("{out}/first.mcap");
    command(root, &program, &["run", &study, "--out", &out, "--mcap", &log, "--csv", "--quiet"])?;
    command(folder, "node", &["studio.mjs", &program, &study, "--replay", &log])
}
