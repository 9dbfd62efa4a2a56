//! House rules about files, read with `syn`: who uses whom, and how long things are.

mod circles;
mod figures;
mod names;
mod tree;
mod uses;

use std::fs;
use std::path::Path;

use tree::Tree;

/// What is only to become less, per crate; every crate that is not named has none of any.
struct Known {
    name: &'static str,
    /// Files that lie on a circle.
    circles: usize,
    /// Functions of more than 80 lines.
    long: usize,
    /// `Result<_, String>`.
    texts: usize,
}

const KNOWN: [Known; 3] = [
    Known { name: "phihat-certificate", circles: 35, long: 3, texts: 0 },
    Known { name: "phihat-model", circles: 0, long: 0, texts: 1 },
    Known { name: "phihat-sim", circles: 0, long: 0, texts: 3 },
];

/// Everything that the rules do not allow, over every crate of the workspace.
pub(crate) fn wrong(root: &Path) -> Result<Vec<String>, String> {
    let (mut wrong, mut lines) = (Vec::new(), Vec::new());
    for (name, tree) in crates(root)? {
        let known = KNOWN.iter().find(|known| known.name == name);
        let (on_circles, told) = circles::told(&tree);
        wrong.extend(more(
            &name,
            "files on circles",
            on_circles,
            known.map_or(0, |k| k.circles),
            &told,
        ));
        let long = figures::long_functions(&tree);
        wrong.extend(more(
            &name,
            "functions over 80 lines",
            long.len(),
            known.map_or(0, |k| k.long),
            &long,
        ));
        lines.extend(figures::lines(&tree));
        // The project's chores tell a person, and nobody else.
        if name == "xtask" {
            continue;
        }
        let texts = figures::errors_of_text(&tree);
        wrong.extend(more(
            &name,
            "Result<_, String>",
            texts.len(),
            known.map_or(0, |k| k.texts),
            &texts,
        ));
    }
    wrong.extend(figures::median(lines));
    Ok(wrong)
}

/// One line, and the places, if something is there more often than it was.
fn more(name: &str, what: &str, count: usize, most: usize, places: &[String]) -> Option<String> {
    (count > most)
        .then(|| format!("{name}: {count} {what}, where {most} were:\n  {}", places.join("\n  ")))
}

/// The name and the files of every crate, without its tests.
fn crates(root: &Path) -> Result<Vec<(String, Tree)>, String> {
    let mut folders = vec![root.join("xtask")];
    let all = root.join("crates");
    for entry in fs::read_dir(&all).map_err(|e| format!("{}: {e}", all.display()))? {
        folders.push(entry.map_err(|e| e.to_string())?.path());
    }
    folders.sort();
    let mut found = Vec::new();
    for folder in folders {
        let source = folder.join("src");
        let read = |file: &str| fs::read_to_string(source.join(file)).ok();
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        for main in ["lib.rs", "main.rs"] {
            if source.join(main).exists() {
                let tree = Tree::read(main, &read).map_err(|e| format!("{name}: {e}"))?;
                let program = if main == "main.rs" && name != "xtask" { ", program" } else { "" };
                found.push((format!("{name}{program}"), tree));
            }
        }
    }
    Ok(found)
}
