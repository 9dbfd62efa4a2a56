//! Labels of equations: each is defined once in the repository, and whatever refers to one finds it.
//!
//! | form | meaning |
//! |---|---|
//! | `\tag{T1}` in a page of `docs/theory` | definition |
//! | `**A1**` at the beginning of a row of `docs/theory/assumptions.md` | definition of an assumption |
//! | a comment of Rust that ends with two blanks and `(B1)` | definition, for equations that the code alone has |
//! | a comment of Rust that ends with `as (T1)`, and any other `(T1)` | reference |

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Texts of this form that are no labels, with their meaning.
const OTHERS: [(&str, &str); 2] =
    [("H3", "a hypothesis of `phihat-paper`"), ("RK4", "a method of Runge and Kutta")];

/// Folders that are searched, and files beside them.
const FOLDERS: [&str; 5] = ["crates", "docs", "examples", "tools", "xtask/src"];
const FILES: [&str; 5] =
    ["README.md", "NOTATION.md", "GLOSSARY.md", "DESIGN.md", "ARCHITECTURE.md"];
const ENDINGS: [&str; 9] = ["rs", "md", "py", "pyi", "h", "hpp", "c", "cpp", "mjs"];

/// Places of definitions and of references, by label.
#[derive(Debug, Default, PartialEq)]
struct Labels {
    defined: BTreeMap<String, Vec<String>>,
    referred: BTreeMap<String, Vec<String>>,
}

impl Labels {
    /// Adds those of one file.
    fn read(&mut self, name: &str, text: &str) {
        let is_theory = name.starts_with("docs/theory/");
        let is_rust = Path::new(name).extension().is_some_and(|ending| ending == "rs");
        for (number, line) in text.lines().enumerate() {
            let place = format!("{name}:{}", number + 1);
            if is_theory {
                for label in enclosed(line, "\\tag{", '}') {
                    self.defined.entry(label.1).or_default().push(place.clone());
                }
            }
            if name == "docs/theory/assumptions.md" && line.starts_with("| **") {
                for label in enclosed(line, "| **", '*').into_iter().take(1) {
                    self.defined.entry(label.1).or_default().push(place.clone());
                }
            }
            let comment = is_rust && line.trim_start().starts_with("//");
            for (at, label) in enclosed(line, "(", ')') {
                let is_last = at + label.len() + 2 == line.trim_end().len();
                let defines = comment && is_last && line[..at].ends_with("  ");
                let places = if defines { &mut self.defined } else { &mut self.referred };
                places.entry(label).or_default().push(place.clone());
            }
        }
    }

    /// Sentences about labels that are defined twice, or not at all.
    fn wrong(&self) -> Vec<String> {
        let twice = self.defined.iter().filter(|(_, places)| places.len() > 1).map(|(label, at)| {
            format!(
                "({label}) is defined at {}; one label has one meaning (write `as ({label})` where the same equation \
                 is repeated)",
                at.join(" and ")
            )
        });
        let is_other = |label: &str| OTHERS.iter().any(|(other, _)| *other == label);
        let undefined = self
            .referred
            .iter()
            .filter(|(label, _)| !self.defined.contains_key(*label) && !is_other(label))
            .map(|(label, at)| format!("{}: ({label}) is defined nowhere", at.join(", ")));
        twice.chain(undefined).collect()
    }
}

/// Labels between two texts, each with the byte at which the first of the two begins: one or two capitals, then
/// one or two digits.
fn enclosed(line: &str, before: &str, after: char) -> Vec<(usize, String)> {
    let is_label = |text: &str| {
        let letters = text.bytes().take_while(u8::is_ascii_uppercase).count();
        let digits = text.len() - letters;
        let rest = text.as_bytes().get(letters..).unwrap_or_default();
        (1..=2).contains(&letters)
            && (1..=2).contains(&digits)
            && rest.iter().all(u8::is_ascii_digit)
    };
    line.match_indices(before)
        .filter_map(|(at, _)| {
            let inside = line[at + before.len()..].split(after).next().unwrap_or_default();
            is_label(inside).then(|| (at, inside.to_owned()))
        })
        .collect()
}

/// Sentences about the labels of the repository that break the rule.
pub(crate) fn wrong(root: &Path) -> Result<Vec<String>, String> {
    let mut labels = Labels::default();
    let mut read = |path: &Path| -> Result<(), String> {
        let name = path.strip_prefix(root).unwrap_or(path).display().to_string();
        let text = fs::read_to_string(path).map_err(|e| format!("{name}: {e}"))?;
        labels.read(&name, &text);
        Ok(())
    };
    for file in FILES {
        read(&root.join(file))?;
    }
    let mut folders: Vec<_> = FOLDERS.iter().map(|folder| root.join(folder)).collect();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            let path = entry.map_err(|e| e.to_string())?.path();
            let skip = ["target", "node_modules", "labels.rs"].iter().any(|n| path.ends_with(n));
            let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
            if path.is_dir() && !skip {
                folders.push(path);
            } else if ENDINGS.contains(&ending) && !skip {
                read(&path)?;
            }
        }
    }
    Ok(labels.wrong())
}

#[cfg(test)]
mod tests {
    use super::Labels;

    fn wrong(files: &[(&str, &str)]) -> Vec<String> {
        let mut labels = Labels::default();
        for (name, text) in files {
            labels.read(name, text);
        }
        labels.wrong()
    }

    const THEORY: (&str, &str) = ("docs/theory/law.md", "```math\nx = 1 \\tag{T1}\n```\n");

    #[test]
    fn a_label_that_is_repeated_or_referred_to_is_fine() {
        let code = "/// x = 1      as (T1)\n/// y = 2     (B1)\n// By (T1) and (B1), of (9) and f(X) alone.\n";
        assert_eq!(wrong(&[THEORY, ("crates/a/src/a.rs", code)]), [""; 0]);
    }

    #[test]
    fn a_label_with_two_meanings_is_found() {
        let found = wrong(&[THEORY, ("crates/a/src/a.rs", "/// z = 3     (T1)\n")]);
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("docs/theory/law.md:2 and crates/a/src/a.rs:1"), "{found:?}");
    }

    #[test]
    fn a_label_that_nobody_defines_is_found() {
        let found = wrong(&[THEORY, ("README.md", "by (T1)\nby (T2)\n")]);
        assert_eq!(found, ["README.md:2: (T2) is defined nowhere"]);
    }

    #[test]
    fn assumptions_are_defined_in_their_table() {
        let table = ("docs/theory/assumptions.md", "| **A1** rigid | links | – |\n");
        assert_eq!(wrong(&[table, ("docs/theory/tube.md", "by (A1)")]), [""; 0]);
        let twice = ("docs/theory/class.md", "x \\tag{A1}");
        assert_eq!(wrong(&[table, twice]).len(), 1);
    }
}
