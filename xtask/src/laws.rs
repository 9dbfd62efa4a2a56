//! `cargo xtask laws`: laws from positions against laws fed with velocity, measured and kept in docs/laws.md.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::shell::{read, write};

/// File of the tables, and the marks around them.
const FILE: &str = "docs/laws.md";
const BEGIN: &str = "<!-- tables, by cargo xtask laws -->\n";
const END: &str = "<!-- end of tables -->";

/// Measures, optimised. Without arguments, or with only `--json FILE` or `--fresh`, it measures everything
/// and stores it in the docs; with the name of a part, it prints that part.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    let build = ["run", "--quiet", "--release", "-p", "phihat-compare", "--example", "laws", "--"];
    let output = Command::new("cargo")
        .args(build)
        .args(arguments)
        .current_dir(root)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo cannot be started: {e}"))?;
    if !output.status.success() {
        return Err(format!("laws: {}", output.status));
    }
    let tables = String::from_utf8_lossy(&output.stdout).into_owned();
    println!("{tables}");
    let file = arguments.iter().position(|word| word == "--json").map(|at| at + 1);
    let mut words = arguments.iter().enumerate().filter(|(at, _)| Some(*at) != file);
    if words.any(|(_, word)| !word.starts_with("--")) {
        return Ok(());
    }
    let path = root.join(FILE);
    let page = between(&read(&path)?, tables.trim_end())
        .ok_or(format!("{FILE} has no place for tables"))?;
    write(&path, &page)
}

/// A page with other tables.
fn between(page: &str, tables: &str) -> Option<String> {
    let (before, rest) = page.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    Some(format!("{before}{BEGIN}\n{tables}\n\n{END}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_put_between_their_marks_again_and_again() {
        let page = format!("a\n{BEGIN}{END}\nb\n");
        let once = between(&page, "| x |").unwrap_or_default();
        assert_eq!(once, format!("a\n{BEGIN}\n| x |\n\n{END}\nb\n"));
        assert_eq!(between(&once, "| x |"), Some(once));
        assert_eq!(between("no marks", "| x |"), None);
    }
}
