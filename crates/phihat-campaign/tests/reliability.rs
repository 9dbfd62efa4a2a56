//! The table of failure modes is true: every row has a test that exists, and every test of a row is in the table.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Names of the form `f07_…` after a mark in a text.
fn names(text: &str, mark: &str) -> BTreeSet<String> {
    let of_row = |name: &str| {
        let bytes = name.as_bytes();
        bytes.len() > 4
            && bytes[0] == b'f'
            && bytes[1..3].iter().all(u8::is_ascii_digit)
            && bytes[3] == b'_'
    };
    let word = |at: usize| {
        let rest = &text[at + mark.len()..];
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        rest[..end].to_owned()
    };
    text.match_indices(mark).map(|(at, _)| word(at)).filter(|name| of_row(name)).collect()
}

/// Every test of a row in the project.
fn tests() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        let folder = entry.unwrap().path().join("tests");
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "rs") {
                found.extend(names(&fs::read_to_string(path).unwrap(), "fn "));
            }
        }
    }
    found
}

#[test]
fn every_row_names_its_tests_and_every_test_its_row() {
    let table = fs::read_to_string(root().join("docs/reliability.md")).unwrap();
    let (exist, listed) = (tests(), names(&table, "`"));
    let missing: Vec<_> = listed.difference(&exist).collect();
    assert!(missing.is_empty(), "docs/reliability.md names tests that do not exist: {missing:?}");
    let forgotten: Vec<_> = exist.difference(&listed).collect();
    assert!(forgotten.is_empty(), "docs/reliability.md lacks tests: {forgotten:?}");
    for row in 1..=35 {
        let line = table.lines().find(|line| line.starts_with(&format!("| F{row} |")));
        let line = line.unwrap_or_else(|| panic!("docs/reliability.md has no row F{row}"));
        assert!(
            names(line, "`").iter().any(|name| name.starts_with(&format!("f{row:02}_"))),
            "row F{row} names no test of its own"
        );
    }
}

#[test]
fn every_fault_of_the_matrix_stands_for_a_row() {
    let table = fs::read_to_string(root().join("docs/reliability.md")).unwrap();
    for fault in phihat_campaign::faults::FAULTS {
        let start = format!("| {} |", fault.row);
        let line = table.lines().find(|line| line.starts_with(&start)).unwrap();
        assert!(line.contains(&format!("`{}`", fault.name)), "{} lacks {}", fault.row, fault.name);
    }
}
