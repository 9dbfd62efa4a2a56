//! House rules about files, read with `syn`: who uses whom, and how long things are.

mod circles;
mod figures;
mod names;
mod reach;
mod repeated;
mod tree;
mod uses;

use std::fs;
use std::path::Path;

pub(crate) use reach::SourceLines;
use tree::ModuleTree;

/// Everything that the rules do not allow, over every crate of the workspace.
pub(crate) fn wrong(root: &Path) -> Result<Vec<String>, String> {
    let (mut wrong, mut lines, mut types) = (Vec::new(), Vec::new(), Vec::new());
    // Their documents are the same bytes on every machine, and in a browser.
    let mut same_everywhere = crate::arrows::may_reach("phihat-web");
    // A law beside phihat's makes no document.
    for beside in ["phihat-campaign", "phihat-compare", "phihat-rivals"] {
        same_everywhere.remove(beside);
    }
    for (name, tree) in crates(root)? {
        wrong.extend(some(&name, "files on circles", &circles::told(&tree).1));
        wrong.extend(some(&name, "functions over 80 lines", &figures::long_functions(&tree)));
        if name == "phihat" {
            wrong.extend(some(&name, "let among other conditions", &figures::let_chains(&tree)));
        }
        if same_everywhere.contains(&*name) {
            let what =
                "functions of the machine's library, where `libm` has the same bits everywhere";
            wrong.extend(some(&name, what, &figures::of_the_machine(&tree)));
        }
        lines.extend(figures::lines(&tree));
        types.extend(repeated::types(&name, &tree));
        // The project's chores tell a person, and nobody else.
        if name != "xtask" {
            wrong.extend(some(&name, "Result<_, String>", &figures::errors_of_text(&tree)));
        }
    }
    wrong.extend(figures::median(lines));
    wrong.extend(repeated::wrong(types));
    Ok(wrong)
}

/// Lines of code of every crate, and who uses whom in it.
pub(crate) fn source_lines(root: &Path) -> Result<Vec<SourceLines>, String> {
    let of = |(name, tree): (String, ModuleTree)| SourceLines::of(name, &tree);
    Ok(crates(root)?.into_iter().map(of).collect())
}

/// One line, and the places, if something is there that no crate has.
fn some(name: &str, what: &str, places: &[String]) -> Option<String> {
    (!places.is_empty()).then(|| format!("{name}: {what}:\n  {}", places.join("\n  ")))
}

/// The name and the files of every crate, without its tests.
fn crates(root: &Path) -> Result<Vec<(String, ModuleTree)>, String> {
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
                let tree = ModuleTree::read(main, &read).map_err(|e| format!("{name}: {e}"))?;
                let program = if main == "main.rs" && name != "xtask" { ", program" } else { "" };
                found.push((format!("{name}{program}"), tree));
            }
        }
    }
    Ok(found)
}
