//! Dependencies that the workspace may have: licences, sources, versions side by side; offline, from the lock
//! file and what is downloaded already.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

/// The only source of packages that are not ours.
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// Licences that ask for no more than to be named; one alternative of a package's licence consists of these.
const LICENCES: [&str; 12] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "ISC",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
    "0BSD",
    "CC0-1.0",
];

/// Packages under the MPL, used unchanged and in tests only.
const TESTS_ONLY: [&str; 5] =
    ["cbindgen", "cssparser", "cssparser-macros", "dtoa-short", "selectors"];

/// Packages that are there in several versions, and who brings the other one.
const TWICE: [(&str, usize, &str); 24] = [
    ("base64", 2, "parquet, resvg"),
    ("darling", 2, "clarabel, when it is built"),
    ("darling_core", 2, "clarabel, when it is built"),
    ("darling_macro", 2, "clarabel, when it is built"),
    ("getrandom", 3, "rand of cmaes, tempfile"),
    ("itertools", 2, "clarabel"),
    ("miniz_oxide", 2, "resvg"),
    ("num-bigint", 2, "parquet"),
    ("r-efi", 2, "getrandom"),
    ("rand", 2, "cmaes, proptest"),
    ("rand_core", 2, "cmaes, proptest"),
    ("roxmltree", 2, "resvg"),
    ("safe_arch", 2, "simba of nalgebra, which has no vectors of eight"),
    ("shlex", 2, "trycmd"),
    ("strsim", 2, "clarabel, when it is built"),
    ("syn", 3, "proc macros"),
    ("thiserror", 2, "ros2-client, behind a feature"),
    ("thiserror-impl", 2, "ros2-client, behind a feature"),
    ("web-time", 2, "clarabel, in a browser"),
    ("wide", 2, "simba of nalgebra, which has no vectors of eight"),
    ("windows-sys", 2, "ros2-client, behind a feature, on Windows"),
    ("toml", 2, "cbindgen"),
    ("toml_datetime", 2, "cbindgen"),
    ("winnow", 2, "cbindgen"),
];

/// Everything that the rules above do not allow.
pub(crate) fn wrong(root: &Path) -> Result<Vec<String>, String> {
    let lock = root.join("Cargo.lock");
    let text = fs::read_to_string(&lock).map_err(|e| format!("{}: {e}", lock.display()))?;
    let mut wrong = sources_and_versions(&text);
    wrong.extend(licences(root)?);
    Ok(wrong)
}

fn sources_and_versions(lock: &str) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    for package in lock.split("[[package]]").skip(1) {
        let value = |key: &str| {
            let line = package.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
            line.map(|value| value.trim_matches('"'))
        };
        let name = value("name").unwrap_or_default();
        *count.entry(name).or_default() += 1;
        match value("source") {
            None if name.starts_with("phihat") || name == "xtask" => {}
            Some(REGISTRY) => {}
            other => {
                wrong.push(format!("Cargo.lock: {name} comes from {other:?}, not from crates.io"));
            }
        }
    }
    for (name, count) in count {
        let allowed = TWICE.iter().find(|(known, ..)| *known == name).map_or(1, |(_, n, _)| *n);
        if count != allowed {
            wrong.push(format!(
                "Cargo.lock: {name} is there in {count} versions, {allowed} are known"
            ));
        }
    }
    wrong
}

/// Licences of what is built on this machine.
fn licences(root: &Path) -> Result<Vec<String>, String> {
    let text = |command: &mut Command| {
        let output = command.current_dir(root).output().map_err(|e| e.to_string())?;
        String::from_utf8(output.stdout).map_err(|e| e.to_string())
    };
    let about = text(Command::new("rustc").arg("-vV"))?;
    let host = about.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or_default();
    let arguments = ["metadata", "--format-version", "1", "--locked", "--filter-platform", host];
    let metadata: serde_json::Value =
        serde_json::from_str(&text(Command::new("cargo").args(arguments))?)
            .map_err(|e| format!("cargo metadata: {e}"))?;
    let mut wrong = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let name = package["name"].as_str().unwrap_or_default();
        let licence = package["license"].as_str().unwrap_or_default();
        let fine = licence == "MPL-2.0" && TESTS_ONLY.contains(&name);
        if !fine && !allowed(licence) {
            wrong.push(format!("{name}: licence {licence:?} is not one that we take"));
        }
    }
    Ok(wrong)
}

/// Returns true if one alternative of an expression consists of allowed licences.
fn allowed(expression: &str) -> bool {
    let flat = expression.replace(['(', ')'], "").replace('/', " OR ");
    // "a OR b AND c" as crates write it: "(a OR b) AND c".
    flat.split(" AND ").all(|part| part.split(" OR ").any(|one| LICENCES.contains(&one.trim())))
}

#[cfg(test)]
mod tests {
    use super::{REGISTRY, allowed, sources_and_versions};

    #[test]
    fn licences_are_read_by_their_alternatives() {
        for fine in
            ["MIT", "GPL-3.0 OR MIT", "MIT/Apache-2.0", "(MIT OR Apache-2.0) AND Unicode-3.0"]
        {
            assert!(allowed(fine), "{fine}");
        }
        for not in ["", "GPL-3.0", "MIT AND GPL-3.0", "MPL-2.0"] {
            assert!(!allowed(not), "{not}");
        }
    }

    #[test]
    fn other_sources_and_second_versions_are_told() {
        let package = |name: &str, source: &str| {
            format!("[[package]]\nname = \"{name}\"\nversion = \"1\"\nsource = \"{source}\"\n\n")
        };
        let lock =
            package("serde", REGISTRY) + &package("serde", REGISTRY) + &package("odd", "git+x");
        let wrong = sources_and_versions(&lock);
        assert_eq!(wrong.len(), 2, "{wrong:?}");
        assert!(sources_and_versions(&package("serde", REGISTRY)).is_empty());
        assert_eq!(sources_and_versions("[[package]]\nname = \"stranger\"\n").len(), 1);
    }
}
