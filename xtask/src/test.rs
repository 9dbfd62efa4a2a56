//! `cargo xtask test`: everything that must hold, in the order of what fails fastest.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use crate::shell::{EVERYTHING, cargo, command, root, tested};
use crate::{attack, binaries, bindings, bless, book, instructions, mutants, pages, rules, twice};

/// One check: what a person reads, and what runs.
type Step = (&'static str, fn(&Path) -> Result<(), String>);

const STEPS: [Step; 18] = [
    ("format", |root| cargo(root, &["fmt", "--all", "--check"])),
    ("house rules", rules::check),
    ("lints", |root| {
        let all = ["clippy", "--workspace", "--all-targets", "--quiet"];
        cargo(root, &[&all[..], &EVERYTHING, &["--", "-Dwarnings"]].concat())?;
        // The core compiles with an older Rust than the rest: nothing of a newer library is in it.
        let core =
            ["clippy", "-p", "phihat", "--lib", "--quiet", "--", "-Dclippy::incompatible_msrv"];
        cargo(root, &core)
    }),
    ("Rust, command-line and report tests, and benches briefly", binaries::run),
    ("documentation tests", |root| {
        cargo(root, &[&["test", "--workspace", "--doc"][..], &EVERYTHING].concat())
    }),
    ("documentation", documentation),
    ("the core cannot panic or allocate", rules::core_is_bare),
    ("instructions of a sample", instructions::check),
    ("release build", release),
    ("the README's main job", main_job),
    ("an attack on certificates", |root| {
        let size = ["60", "--runs", "4", "--searched", "0", "--alone", "--fresh"].map(String::from);
        attack::run(root, &size)
    }),
    ("the README prints what is printed", bless::check),
    ("the book", book::check),
    ("the paper's reproduction is what the repository keeps", bless::reproduced),
    ("the report in a browser", browser),
    ("C and C++", bindings::c),
    ("packages for a registry", |root| rules::packages(root, false)),
    ("Python", bindings::python),
];

/// Checks that are run by name alone: what they find does not come with a commit, or not often.
const ASKED: [Step; 2] = [
    ("two builds, one library", |root| twice::run(root, Some("phihat-c"))),
    ("some mutants of the core", mutants::rotate),
];

/// Runs every step of [`STEPS`], or those of both lists whose name contains an argument; stops at the first failure.
pub(crate) fn run(args: &[String]) -> Result<(), String> {
    let root = root();
    let start = Instant::now();
    let chosen = |name: &str| args.iter().any(|a| name.contains(a.as_str()));
    let steps: Vec<_> = if args.is_empty() {
        STEPS.iter().collect()
    } else {
        STEPS.iter().chain(&ASKED).filter(|(name, _)| chosen(name)).collect()
    };
    if steps.is_empty() {
        let names: Vec<_> = STEPS.iter().chain(&ASKED).map(|(name, _)| *name).collect();
        return Err(format!("no step is named so; steps: {}", names.join(" · ")));
    }
    for (name, step) in &steps {
        println!("\n── {name}");
        let began = Instant::now();
        step(&root).map_err(|why| format!("\nFAILED: {name}: {why}"))?;
        println!("── {name}: ok, {:.0} s", began.elapsed().as_secs_f64());
    }
    println!("\n{} steps ok in {:.0} s", steps.len(), start.elapsed().as_secs_f64());
    println!("{} passed, 0 failed", steps.len());
    Ok(())
}

/// Builds what a user runs; nothing in it lets the disk be struck.
fn release(root: &Path) -> Result<(), String> {
    cargo(root, &["build", "--release", "--package", "phihat-cli"])?;
    let name = format!("target/release/phihat{}", std::env::consts::EXE_SUFFIX);
    let program = std::fs::read(root.join(&name)).map_err(|e| format!("{name}: {e}"))?;
    let word = b"PHIHAT_STRIKE";
    if program.windows(word.len()).any(|bytes| bytes == word) {
        return Err(format!("{name} can be struck; that belongs behind debug assertions"));
    }
    Ok(())
}

fn documentation(root: &Path) -> Result<(), String> {
    let status = Command::new("cargo")
        .args(["doc", "--workspace", "--no-deps", "--quiet"])
        .args(EVERYTHING)
        .env("RUSTDOCFLAGS", "-Dwarnings")
        .current_dir(root)
        .status()
        .map_err(|e| e.to_string())?;
    if status.success() { Ok(()) } else { Err("cargo doc has warnings".to_owned()) }
}

/// What the README promises a newcomer, run as printed; and two more studies whose reports are looked at.
fn main_job(root: &Path) -> Result<(), String> {
    let studies = ["panda_design", "panda", "first"].map(|name| format!("studies/{name}.toml"));
    studies.iter().try_for_each(|study| cargo(root, &["phihat", "run", study]))
}

/// Chromium, and what drives it: the folder of the checks in a browser.
pub(crate) fn browser_tools(root: &Path) -> Result<PathBuf, String> {
    if Command::new("chromium").arg("--version").output().is_err() {
        println!("installing chromium");
        command(root, "apt-get", &["update", "-qq"])?;
        let packages = ["install", "-y", "-qq", "chromium", "fonts-dejavu-core"];
        command(root, "apt-get", &packages)?;
    }
    let folder = root.join("crates/phihat-report/tests/browser");
    let lines = ["ci", "--no-audit", "--no-fund", "--loglevel=error"];
    command(&folder, "npm", &lines)?;
    Ok(folder)
}

/// The reports of [`main_job`], with traces as texts beside them, which the checks in a browser read; made where they are not there yet.
pub(crate) fn reports(root: &Path) -> Result<Vec<String>, String> {
    let mut pages = Vec::new();
    for study in ["panda", "first", "panda_design"] {
        let record = root.join("out").join(study);
        let page = record.join("report.html");
        if !page.exists() || !record.join("trace.csv").exists() {
            let study = format!("studies/{study}.toml");
            cargo(root, &["phihat", "run", &study, "--csv"])?;
        }
        pages.push(page.display().to_string());
    }
    Ok(pages)
}

/// The reports of [`main_job`], and those with hostile names, in headless Chromium.
fn browser(root: &Path) -> Result<(), String> {
    let folder = browser_tools(root)?;
    let pages = reports(root)?;
    command(&folder, "node", &["check.mjs", &pages[0], &pages[1], &pages[2]])?;
    // Made up, with everything that the page can show; and the paper's, where it was made.
    let made_up = root.join("target/reproduction-page").display().to_string();
    // Not of one name: cargo puts examples of all packages into one folder.
    let example = |package: &str, name: &str, words: &[&str]| {
        command(root, &tested(root, package, name)?.display().to_string(), words)
    };
    example("phihat-paper", "made_up", &[&made_up])?;
    let mut arguments = vec!["check.mjs".to_owned(), "--reproduction".to_owned()];
    arguments.push(format!("{made_up}/page.html"));
    let fresh = root.join("target/reproduction/report.html");
    arguments.extend(fresh.exists().then(|| fresh.display().to_string()));
    let arguments: Vec<_> = arguments.iter().map(String::as_str).collect();
    command(&folder, "node", &arguments)?;
    let small = "compare studies/table1.toml --quick --only pd,computed-torque,proposed-2 --worlds exact,friction";
    let out = root.join("out/browser-compare").display().to_string();
    let words: Vec<_> = small.split(' ').chain(["--out", &out]).collect();
    let program = tested(root, "phihat-cli", "phihat")?.display().to_string();
    command(root, &program, &words)?;
    command(&folder, "node", &["check.mjs", "--comparison", &format!("{out}/report.html")])?;
    // Made anew: what an earlier program left there says nothing of this one.
    let _ = std::fs::remove_dir_all(root.join(pages::FOLDER));
    let plain = pages::PLAIN.into_iter().map(|page| pages::made(root, page));
    let plain = plain.collect::<Result<Vec<_>, _>>()?;
    let words = ["check.mjs", "--plain"].into_iter().chain(plain.iter().map(String::as_str));
    command(&folder, "node", &words.collect::<Vec<_>>())?;
    // Without what an earlier run left there.
    let hostile = root.join("target/hostile");
    let _ = std::fs::remove_dir_all(&hostile);
    let hostile = hostile.display().to_string();
    example("phihat-report", "demo", &[&hostile, "hostile"])?;
    let mut pages: Vec<String> = std::fs::read_dir(&hostile)
        .map_err(|e| format!("{hostile}: {e}"))?
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "html"))
        .map(|path| path.display().to_string())
        .collect();
    pages.sort();
    let mut arguments = vec!["check.mjs", "--hostile"];
    arguments.extend(pages.iter().map(String::as_str));
    command(&folder, "node", &arguments)?;
    studio(root, &folder)
}

/// `phihat studio` in a browser: the Panda under the gains of the main job, a study whose gains are stated, a record, an arm
/// with a mesh, and a log.
fn studio(root: &Path, folder: &Path) -> Result<(), String> {
    let program = tested(root, "phihat-cli", "phihat")?.display().to_string();
    let at = |path: &str| root.join(path).display().to_string();
    let (study, gains) = (at("studies/panda.toml"), at("out/panda/gains.json"));
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
