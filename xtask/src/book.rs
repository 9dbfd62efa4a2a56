//! The book in `docs/book`: it builds, its links lead somewhere, and what it shows is what happens.
//!
//! Fenced blocks of a page, in order, in a scratch folder of the page's own that has a copy of `studies/`:
//!
//! | block | what is done |
//! |---|---|
//! | any with `file=NAME` | written to `NAME` |
//! | `sh` | run line by line; exit code 0, or for its last line as `exit=N` says |
//! | `text,output` | held against what the `sh` block before it printed: each line in this order; `…` stands for what is left out |
//! | `python` | run by the step that has built the Python package, [`python`] |
//! | `console` | nothing: the tests of `phihat-cli` run it by trycmd |
//! | `sh,not-run` | nothing: a text beside it says why |
//! | `text` | nothing: a formula, a folder |
//!
//! Any other block is an error, so that nothing is shown that nobody ran.

use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

use pulldown_cmark::{CodeBlockKind, Event, Parser, Tag, TagEnd};

use crate::shell::{read, write};
use crate::shown::{in_order, renewed};
use crate::{programs, tools};

const SOURCE: &str = "docs/book/src";
/// Folder of the book as it is built.
pub(crate) const HTML: &str = "target/book/html";
const SCRATCH: &str = "target/book/run";

/// The scratch folders of pages' Python, apart: the gate runs both at once, and each begins by emptying its own.
const SCRATCH_PYTHON: &str = "target/book/python";

/// The version that is installed where there is none: built from source, as its authors publish it.
const MDBOOK: &str = "0.5.4";

/// Figures of the book and of the README: page whose commands make them, study, name.
const FIGURES: [(&str, &str, &str); 7] = [
    ("tutorial", "panda_design", "error"),
    ("tutorial", "panda_design", "inertia-window"),
    ("tutorial", "panda_design", "trade-off"),
    ("tutorial", "panda_design", "arm"),
    ("how-to/franka", "panda", "error"),
    ("how-to/franka", "panda_any", "arm"),
    ("docs/theory/stop", "estop_restart", "tracking"),
];

/// Pages whose commands take more than a quarter of a minute or make figures: the gate leaves them to `--all`.
const LONG: [&str; 6] = [
    "tutorial.md",
    "how-to/own-arm.md",
    "how-to/franka.md",
    "how-to/export.md",
    "how-to/budget.md",
    "docs/theory/stop.md",
];

/// Documents outside of the book whose links are followed too, beside those of [`THEORY`].
const DOCUMENTS: [&str; 10] = [
    "README.md",
    "GLOSSARY.md",
    "NOTATION.md",
    "DESIGN.md",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "docs/study.md",
    "docs/reliability.md",
    "docs/zoo.md",
    "docs/speed.md",
];

/// Chapters of the theory, which the book includes whole, and their figures: at the same place in the book as in the
/// repository.
pub(crate) const THEORY: &str = "docs/theory";

/// The program that typesets formulas, with its packages.
pub(crate) const MATH: &str = "tools/math";

/// One fenced block of a page.
#[derive(Debug)]
struct Block {
    line: usize,
    language: String,
    attributes: Vec<String>,
    text: String,
}

impl Block {
    fn has(&self, attribute: &str) -> bool {
        self.attributes.iter().any(|a| a == attribute)
    }

    fn value(&self, key: &str) -> Option<&str> {
        self.attributes.iter().find_map(|a| a.strip_prefix(key)?.strip_prefix('='))
    }
}

/// Part of a page that is run.
#[derive(Clone, Copy, PartialEq)]
enum PagePart<'a> {
    Commands,
    /// The commands, and the output that the page shows is replaced by the present one.
    Renewed,
    Python(&'a str, &'a Path),
}

/// Builds the book, follows its links, and runs the commands of its pages but for [`LONG`].
pub(crate) fn check(root: &Path) -> Result<(), String> {
    checked(root, |page| !LONG.iter().any(|long| page.ends_with(long)))
}

/// Runs the commands of the pages that [`check`] leaves out, and compares the figures that they make with
/// those that are stored.
pub(crate) fn check_long(root: &Path) -> Result<(), String> {
    checked(root, |page| LONG.iter().any(|long| page.ends_with(long)))?;
    for (made, kept) in figures(root) {
        if read(&made)? != read(&kept)? {
            return Err(stale(&kept.display().to_string()));
        }
    }
    Ok(())
}

fn checked(root: &Path, chosen: impl Fn(&Path) -> bool) -> Result<(), String> {
    let program = program(root)?;
    build(root)?;
    let pages = pages(root)?;
    links(root, &pages)?;
    pages
        .iter()
        .filter(|page| chosen(page))
        .try_for_each(|page| run(root, page, PagePart::Commands, &program))
}

/// Runs the book's Python with an interpreter, and the package in a folder beside it.
pub(crate) fn python(root: &Path, interpreter: &str, package: &Path) -> Result<(), String> {
    let program = program(root)?;
    pages(root)?
        .iter()
        .try_for_each(|page| run(root, page, PagePart::Python(interpreter, package), &program))
}

/// Runs the commands of the tutorial with a program that may come from elsewhere.
pub(crate) fn tutorial(root: &Path, program: &Path) -> Result<(), String> {
    run(root, Path::new("tutorial.md"), PagePart::Commands, program)
}

/// Writes what is made of the program: the numbers in the output that pages show, and the figures that the
/// tutorial's runs leave. Numbers in sentences stay: they are in the lines beside those that change.
pub(crate) fn bless(root: &Path) -> Result<(), String> {
    let program = program(root)?;
    for page in pages(root)? {
        run(root, &page, PagePart::Renewed, &program)?;
    }
    figures(root).iter().try_for_each(|(made, kept)| write(kept, &read(made)?))
}

fn stale(what: &str) -> String {
    format!("{what} is stale: run `cargo xtask bless book` and look at the diff")
}

/// Every figure as its page's commands have just drawn it, and as it is kept.
fn figures(root: &Path) -> [(PathBuf, PathBuf); 7] {
    FIGURES.map(|(page, study, name)| {
        let made = format!("{SCRATCH}/{page}/out/{study}/figures/{name}.svg");
        let kept = format!("{SOURCE}/figures/{study}-{name}.svg");
        (root.join(made), root.join(kept))
    })
}

/// mdBook, installed where it is missing: without its server and its watcher.
pub(crate) fn tool(root: &Path) -> Result<PathBuf, String> {
    tools::from_cargo(root, "mdbook", MDBOOK, &["--no-default-features", "--features", "search"])
}

/// The command line program of the gate's build.
fn program(root: &Path) -> Result<PathBuf, String> {
    programs::program(root, "phihat-cli/phihat")
}

/// Builds the page tree and returns its folder.
pub(crate) fn build(root: &Path) -> Result<PathBuf, String> {
    let html = root.join(HTML);
    pages_of(root, Path::new("docs/book"), &html)?;
    copy(&root.join(THEORY).join("figures"), &html.join(THEORY).join("figures"))?;
    Ok(html)
}

/// Builds the pages of a book, with the styles and fonts of its formulas.
pub(crate) fn pages_of(root: &Path, book: &Path, html: &Path) -> Result<(), String> {
    let mdbook = tool(root)?;
    let math = tools::from_npm(root.join(MATH))?;
    let output = Command::new(&mdbook)
        .arg("build")
        .arg(book)
        .arg("--dest-dir")
        .arg(html)
        .current_dir(root)
        .output()
        .map_err(|e| format!("mdbook cannot be started: {e}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    // mdbook goes on after an include that it cannot find.
    if !output.status.success() || ["ERROR", "WARN"].iter().any(|word| said.contains(word)) {
        return Err(format!("mdbook:\n{said}"));
    }
    let (from, to) = (math.join("node_modules/katex/dist"), html.join("katex"));
    copy(&from.join("fonts"), &to.join("fonts"))?;
    write(&to.join("katex.min.css"), &read(&from.join("katex.min.css"))?)
}

/// The pages of the summary, in its order; every Markdown file of the book is among them.
fn pages(root: &Path) -> Result<Vec<PathBuf>, String> {
    let summary = read(&root.join(SOURCE).join("SUMMARY.md"))?;
    let pages: Vec<PathBuf> = targets(&summary).into_iter().map(PathBuf::from).collect();
    let mut folders = vec![root.join(SOURCE)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            let path = entry.map_err(|e| e.to_string())?.path();
            let name = path.strip_prefix(root.join(SOURCE)).unwrap_or(&path).to_owned();
            let markdown = path.extension().is_some_and(|e| e == "md");
            if path.is_dir() {
                folders.push(path);
            } else if markdown && name != Path::new("SUMMARY.md") && !pages.contains(&name) {
                return Err(format!("{}: not in SUMMARY.md", name.display()));
            }
        }
    }
    Ok(pages)
}

/// Targets of a document's links and pictures.
fn targets(markdown: &str) -> Vec<String> {
    let targets = Parser::new(markdown).filter_map(|event| match event {
        Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
            Some(dest_url.into_string())
        }
        _ => None,
    });
    targets.collect()
}

/// Every link inside the book leads to a page and an anchor of it, or to a file; those of the documents, to a file.
fn links(root: &Path, pages: &[PathBuf]) -> Result<(), String> {
    let mut wrong = Vec::new();
    let inside = |target: &&String| !target.contains("://") && !target.starts_with("mailto:");
    for page in pages {
        let path = root.join(SOURCE).join(page);
        let text = included(&path)?;
        for target in targets(&text).iter().filter(inside) {
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let folder = page.parent().unwrap_or(Path::new(""));
            let file = if file.is_empty() { page.clone() } else { flat(&folder.join(file)) };
            let found = if file.extension().is_some_and(|e| e == "md") {
                let html = root.join(HTML).join(file.with_extension("html"));
                let there = || read(&html).is_ok_and(|h| h.contains(&format!("id=\"{anchor}\"")));
                pages.contains(&file) && (anchor.is_empty() || there())
            } else {
                let places = [root.join(SOURCE).join(&file), root.join(HTML).join(&file)];
                places.iter().any(|place| place.is_file())
            };
            if !found {
                wrong.push(format!("{}: {target} leads nowhere", page.display()));
            }
        }
    }
    let chapters = files(&root.join(THEORY))?;
    let documents = DOCUMENTS.iter().map(|document| root.join(document)).chain(chapters);
    for path in documents {
        let document = path.strip_prefix(root).unwrap_or(&path).display();
        for target in targets(&read(&path)?).iter().filter(inside) {
            let file = target.split('#').next().unwrap_or_default();
            if !path.with_file_name("").join(file).exists() {
                wrong.push(format!("{document}: {target} leads nowhere"));
            }
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// Markdown files of a folder, sorted.
fn files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let paths = entries.filter_map(|entry| entry.ok().map(|e| e.path()));
    let mut files: Vec<_> = paths.filter(|p| p.extension().is_some_and(|e| e == "md")).collect();
    files.sort();
    Ok(files)
}

/// A page with the documents that it includes whole.
fn included(page: &Path) -> Result<String, String> {
    let mut text = String::new();
    for line in read(page)?.lines() {
        let name = line.strip_prefix("{{#include ").and_then(|rest| rest.strip_suffix("}}"));
        match name {
            Some(name) => text.push_str(&read(&page.with_file_name("").join(name))?),
            None => text.push_str(line),
        }
        text.push('\n');
    }
    Ok(text)
}

/// A relative path without `.` and `..`, as far as that goes.
fn flat(path: &Path) -> PathBuf {
    let mut flat = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir if flat.pop() => {}
            Component::CurDir => {}
            other => flat.push(other),
        }
    }
    flat
}

/// Runs the blocks of a page in its scratch folder.
fn run(root: &Path, page: &Path, part: PagePart<'_>, program: &Path) -> Result<(), String> {
    let path = root.join(SOURCE).join(page);
    let mut markdown = read(&path)?;
    let blocks = blocks(&markdown);
    let wanted = |block: &Block| match part {
        PagePart::Commands | PagePart::Renewed => block.language == "sh",
        PagePart::Python(..) => block.language == "python",
    };
    for block in &blocks {
        understood(block).map_err(|why| format!("{}:{}: {why}", page.display(), block.line))?;
    }
    if !blocks.iter().any(wanted) {
        return Ok(());
    }
    println!("{}", page.display());
    let scratch = if matches!(part, PagePart::Python(..)) { SCRATCH_PYTHON } else { SCRATCH };
    let folder = root.join(scratch).join(page.with_extension(""));
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    copy(&root.join("studies"), &folder.join("studies"))?;
    let mut printed = None;
    for block in &blocks {
        let mut done = || -> Result<Option<String>, String> {
            if let Some(name) = block.value("file") {
                write(&folder.join(name), &block.text)?;
            }
            match (block.language.as_str(), part) {
                ("sh", PagePart::Commands | PagePart::Renewed) if !block.has("not-run") => {
                    Ok(Some(shell(program, &folder, block)?))
                }
                ("text", PagePart::Commands | PagePart::Renewed) if block.has("output") => {
                    let printed: Option<&String> = printed.as_ref();
                    let printed = printed.ok_or("no commands stand before this output")?;
                    if part == PagePart::Renewed {
                        markdown =
                            markdown.replacen(&block.text, &renewed(&block.text, printed), 1);
                        return Ok(None);
                    }
                    in_order(&block.text, printed).map(|()| None)
                }
                ("python", PagePart::Python(interpreter, package)) => {
                    let mut python = Command::new(interpreter);
                    python.args(["-c", &block.text]).env("PYTHONPATH", package);
                    let status = python.current_dir(&folder).status();
                    let status = status.map_err(|e| format!("{interpreter}: {e}"))?;
                    if status.success() { Ok(None) } else { Err(status.to_string()) }
                }
                _ => Ok(None),
            }
        };
        let what = done().map_err(|why| format!("{}:{}: {why}", page.display(), block.line))?;
        printed = what.or(printed);
    }
    if part == PagePart::Renewed { write(&path, &markdown) } else { Ok(()) }
}

/// Checks that a block is of a known kind.
fn understood(block: &Block) -> Result<(), String> {
    let known = |attribute: &String| match block.language.as_str() {
        "sh" => attribute == "not-run" || attribute.starts_with("exit="),
        "text" => attribute == "output",
        _ => attribute.starts_with("file="),
    };
    if let Some(attribute) = block.attributes.iter().find(|attribute| !known(attribute)) {
        return Err(format!("a block of {} does not know {attribute}", block.language));
    }
    let normal =
        |name: &str| Path::new(name).components().all(|c| matches!(c, Component::Normal(_)));
    if block.value("file").is_some_and(|name| name.is_empty() || !normal(name)) {
        return Err("a listing's file is inside the page's folder".to_owned());
    }
    let run = ["sh", "text", "python", "console"].contains(&block.language.as_str());
    if run || block.value("file").is_some() {
        return Ok(());
    }
    Err(format!("nothing is done with this block of {:?}: name its file=", block.language))
}

/// The fenced blocks of a page.
fn blocks(markdown: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for (event, range) in Parser::new(markdown).into_offset_iter() {
        match event {
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(info))) => {
                let mut words = info.split(',').map(|word| word.trim().to_owned());
                open = Some(Block {
                    line: markdown[..range.start].matches('\n').count() + 1,
                    language: words.next().unwrap_or_default(),
                    attributes: words.collect(),
                    text: String::new(),
                });
            }
            Event::Text(text) => {
                if let Some(block) = &mut open {
                    block.text.push_str(&text);
                }
            }
            Event::End(TagEnd::CodeBlock) => blocks.extend(open.take()),
            _ => {}
        }
    }
    blocks
}

/// Runs a block's lines, each with the exit code that it is to have, and returns all that they print.
fn shell(program: &Path, folder: &Path, block: &Block) -> Result<String, String> {
    let programs = program.parent().unwrap_or(Path::new("")).to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(programs).chain(std::env::split_paths(&path)))
        .map_err(|e| e.to_string())?;
    let last: i32 =
        block.value("exit").map_or(Ok(0), str::parse).map_err(|_| "exit=N, a number")?;
    let text = block.text.replace("\\\n", " ");
    let mut lines = text.lines().filter(|line| !line.trim().is_empty()).peekable();
    let mut printed = String::new();
    while let Some(line) = lines.next() {
        let wanted = if lines.peek().is_none() { last } else { 0 };
        // The alias would build; what it builds is what is on the path.
        let line = line.replace("cargo phihat ", "phihat ");
        let output = Command::new("sh")
            .args(["-c", &format!("exec 2>&1\n{line}")])
            .env("PATH", &path)
            .env_remove("COLUMNS")
            .current_dir(folder)
            .output()
            .map_err(|e| format!("sh cannot be started: {e}"))?;
        let said = String::from_utf8_lossy(&output.stdout);
        if output.status.code() != Some(wanted) {
            return Err(format!(
                "{line}\n{said}{}, and exit code {wanted} is stated",
                output.status
            ));
        }
        printed.push_str(&said);
    }
    Ok(printed)
}

/// Copies a folder with all below it.
pub(crate) fn copy(from: &Path, to: &Path) -> Result<(), String> {
    fs::create_dir_all(to).map_err(|e| format!("{}: {e}", to.display()))?;
    for entry in fs::read_dir(from).map_err(|e| format!("{}: {e}", from.display()))? {
        let path = entry.map_err(|e| e.to_string())?.path();
        let place = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() {
            copy(&path, &place)?;
        } else {
            fs::copy(&path, &place).map_err(|e| format!("{}: {e}", path.display()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{blocks, flat, understood};

    #[test]
    fn blocks_are_read_with_what_stands_beside_their_language() {
        let page =
            "# A\n\n```toml,file=a.toml\nx = 1\n```\n\n```sh,exit=1\nphihat run a.toml\n```\n";
        let found = blocks(page);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].value("file"), found[0].line), (Some("a.toml"), 3));
        assert_eq!(
            (found[1].value("exit"), found[1].text.as_str()),
            (Some("1"), "phihat run a.toml\n")
        );
    }

    #[test]
    fn what_nobody_runs_is_refused() {
        for (fence, fine) in [
            ("sh", true),
            ("sh,not-run", true),
            ("text,output", true),
            ("toml,file=a.toml", true),
            ("toml", false),
            ("rust", false),
            ("sh,later", false),
            ("toml,file=../a.toml", false),
            ("toml,file=/a.toml", false),
        ] {
            let found = blocks(&format!("```{fence}\nx\n```\n"));
            assert_eq!(understood(&found[0]).is_ok(), fine, "{fence}");
        }
    }

    #[test]
    fn paths_are_made_flat() {
        assert_eq!(flat(Path::new("a/../b/./c.md")), Path::new("b/c.md"));
        assert_eq!(flat(Path::new("../b.md")), Path::new("../b.md"));
    }
}
