//! `cargo xtask check`: what can be said of an edit within a minute. It looks at the crates that differ from `HEAD`
//! and the tests that were edited only, and ends with what it left out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::rules;
use crate::shell::cargo;

/// Files that every crate stands on: with these changed, only the whole test says something.
const SHARED: [&str; 4] = ["Cargo.toml", "Cargo.lock", "clippy.toml", ".cargo/config.toml"];

/// One crate of the workspace.
#[derive(Debug, Default)]
struct Package {
    /// Its folder, from the workspace's root, with a slash at the end.
    folder: String,
    /// It has a library, with unit tests or without.
    library: bool,
    /// Its library, a binary or an example has tests inside.
    units: bool,
    /// It has examples that are tests.
    examples: bool,
    /// Files of its integration tests, which are modules of one program.
    tests: Vec<String>,
    /// Crates of ours that it uses.
    uses: BTreeSet<String>,
    /// Crates of ours that its tests use besides.
    tests_use: BTreeSet<String>,
}

type CratesOfWorkspace = BTreeMap<String, Package>;

/// Format, house rules, then lints and unit tests of the crates that were changed.
pub(crate) fn run(root: &Path) -> Result<(), String> {
    let start = Instant::now();
    let workspace = workspace(root)?;
    let files = changed_files(root)?;
    let changed = changed_crates(&workspace, &files);
    println!("── format");
    cargo(root, &["fmt", "--all", "--check"])?;
    println!("── house rules");
    rules::check(root)?;
    let names: Vec<&str> = changed.iter().map(String::as_str).collect();
    if names.is_empty() {
        println!("── no crate differs from HEAD");
    } else {
        println!("── lints: {}", names.join(", "));
        let which = names.iter().flat_map(|name| ["-p", name]);
        let mut words = vec!["clippy", "--quiet", "--bins", "--examples"];
        words.extend(names.iter().any(|name| workspace[*name].library).then_some("--lib"));
        words.extend(which);
        words.extend(["--", "-Dwarnings"]);
        cargo(root, &words)?;
    }
    let (tested, circular) = testable(&workspace, &changed);
    for name in &tested {
        println!("── unit tests: {name}");
        let mut words = vec!["test", "--quiet", "-p", name.as_str(), "--bins"];
        words.extend(workspace[name].library.then_some("--lib"));
        words.extend(workspace[name].examples.then_some("--examples"));
        cargo(root, &words)?;
    }
    for (name, test) in edited_tests(&workspace, &files) {
        println!("── the test {test} of {name}, which was edited");
        cargo(root, &["clippy", "--quiet", "-p", name, "--tests", "--", "-Dwarnings"])?;
        let inside = format!("{test}::");
        cargo(root, &["test", "--quiet", "-p", name, "--test", "tests", "--", &inside])?;
    }
    println!("\nok in {:.0} s. Left out:", start.elapsed().as_secs_f64());
    for line in left_out(&workspace, &files, &changed, &circular) {
        println!("  {line}");
    }
    println!("  all else that `cargo xtask test` looks at: run that before you hand in");
    Ok(())
}

/// Files that differ from `HEAD`, and new ones that git does not ignore.
fn changed_files(root: &Path) -> Result<Vec<String>, String> {
    let list = |words: &[&str]| -> Result<Vec<String>, String> {
        let output = Command::new("git")
            .args(words)
            .current_dir(root)
            .output()
            .map_err(|e| format!("git cannot be started: {e}"))?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).trim().to_owned());
        }
        Ok(String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect())
    };
    let mut files = list(&["diff", "--name-only", "--no-renames", "HEAD"])?;
    files.extend(list(&["ls-files", "--others", "--exclude-standard"])?);
    files.sort();
    Ok(files)
}

fn workspace(root: &Path) -> Result<CratesOfWorkspace, String> {
    let output = Command::new("cargo")
        .args(["metadata", "--format-version", "1", "--no-deps"])
        .current_dir(root)
        .output()
        .map_err(|e| e.to_string())?;
    let metadata: serde_json::Value =
        serde_json::from_slice(&output.stdout).map_err(|e| format!("cargo metadata: {e}"))?;
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let named = |value: &serde_json::Value| value["name"].as_str().unwrap_or_default().to_owned();
    let ours: BTreeSet<String> = packages.clone().map(named).collect();
    let root = root.canonicalize().map_err(|e| e.to_string())?;
    Ok(packages
        .map(|package| {
            let manifest = Path::new(package["manifest_path"].as_str().unwrap_or_default());
            let folder = manifest.parent().and_then(|folder| folder.strip_prefix(&root).ok());
            let folder = folder.map(|folder| format!("{}/", folder.display())).unwrap_or_default();
            let mut entry = Package { folder, ..Package::default() };
            for target in package["targets"].as_array().into_iter().flatten() {
                let kinds = target["kind"].as_array().into_iter().flatten();
                let kinds: Vec<&str> = kinds.filter_map(|kind| kind.as_str()).collect();
                entry.library |= kinds.iter().any(|kind| kind.ends_with("lib"));
                if kinds.contains(&"test") {
                    entry.tests.extend(modules(target["src_path"].as_str().unwrap_or_default()));
                } else if target["test"] == true {
                    entry.units = true;
                    entry.examples |= kinds.contains(&"example");
                }
            }
            for dependency in package["dependencies"].as_array().into_iter().flatten() {
                let on = named(dependency);
                if ours.contains(&on) {
                    let only_tests = dependency["kind"] == "dev";
                    let set = if only_tests { &mut entry.tests_use } else { &mut entry.uses };
                    set.insert(on);
                }
            }
            (named(package), entry)
        })
        .collect())
}

/// The crates that files belong to.
fn changed_crates(workspace: &CratesOfWorkspace, files: &[String]) -> BTreeSet<String> {
    files.iter().filter_map(|file| crate_of(workspace, file)).map(str::to_owned).collect()
}

fn crate_of<'a>(workspace: &'a CratesOfWorkspace, file: &str) -> Option<&'a str> {
    let owner = workspace
        .iter()
        .find(|(_, package)| !package.folder.is_empty() && file.starts_with(&package.folder));
    owner.map(|(name, _)| name.as_str())
}

/// Modules of a program of tests.
fn modules(main: &str) -> Vec<String> {
    let text = std::fs::read_to_string(main).unwrap_or_default();
    let names = text.lines().filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
    names.map(str::to_owned).collect()
}

/// Integration tests that are among the files: their crate's name and their own.
fn edited_tests<'a>(workspace: &'a CratesOfWorkspace, files: &[String]) -> Vec<(&'a str, &'a str)> {
    let all = workspace
        .iter()
        .flat_map(|(name, package)| package.tests.iter().map(move |test| (name, package, test)));
    all.filter(|(_, package, test)| files.contains(&format!("{}tests/{test}.rs", package.folder)))
        .map(|(name, _, test)| (name.as_str(), test.as_str()))
        .collect()
}

/// The crates that can be tested soon; and those that cannot, since their tests use crates that are built on
/// them and would all be built again.
fn testable(
    workspace: &CratesOfWorkspace,
    changed: &BTreeSet<String>,
) -> (BTreeSet<String>, BTreeSet<String>) {
    let with_units = changed.iter().filter(|name| workspace[*name].units).cloned();
    with_units.partition(|name| {
        let above = users(workspace, &BTreeSet::from([name.clone()]));
        workspace[name].tests_use.is_disjoint(&above)
    })
}

/// Every crate that is built on one of these, without them.
fn users(workspace: &CratesOfWorkspace, below: &BTreeSet<String>) -> BTreeSet<String> {
    let mut reached = below.clone();
    loop {
        let next: Vec<_> = workspace
            .iter()
            .filter(|(name, package)| {
                !reached.contains(*name) && !package.uses.is_disjoint(&reached)
            })
            .map(|(name, _)| name.clone())
            .collect();
        if next.is_empty() {
            return reached.difference(below).cloned().collect();
        }
        reached.extend(next);
    }
}

/// Parts that were not checked, one line each.
fn left_out(
    workspace: &CratesOfWorkspace,
    files: &[String],
    changed: &BTreeSet<String>,
    circular: &BTreeSet<String>,
) -> Vec<String> {
    let mut lines = Vec::new();
    for name in circular {
        lines.push(format!(
            "unit tests of {name}: its tests use crates that are built on it: cargo test -p {name} --lib"
        ));
    }
    for name in changed {
        let run = edited_tests(workspace, files);
        let tests = workspace[name].tests.iter().map(String::as_str);
        let tests: Vec<_> = tests.filter(|test| !run.contains(&(name.as_str(), *test))).collect();
        if !tests.is_empty() {
            let all = tests.join(", ");
            lines.push(format!("tests of {name}: {all}: cargo test -p {name} NAME::"));
        }
    }
    if !changed.is_empty() {
        lines.push("lints of tests and benches, documentation and its tests".to_owned());
    }
    let above: Vec<_> = users(workspace, changed).into_iter().collect();
    if !above.is_empty() {
        lines.push(format!("crates that are built on these: {}", above.join(", ")));
    }
    for file in files {
        if SHARED.contains(&file.as_str()) {
            lines.push(format!("what {file} changes in every crate"));
        } else if crate_of(workspace, file).is_none() {
            lines.push(format!("{file}: of no crate"));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::{
        BTreeSet, CratesOfWorkspace, Package, changed_crates, crate_of, edited_tests, left_out,
        testable, users,
    };

    fn package(folder: &str, uses: &[&str], tests_use: &[&str]) -> Package {
        let set = |names: &[&str]| names.iter().map(ToString::to_string).collect();
        Package {
            folder: folder.to_owned(),
            library: true,
            units: true,
            examples: false,
            tests: vec!["laws".to_owned()],
            uses: set(uses),
            tests_use: set(tests_use),
        }
    }

    /// `top` → `middle` → `base`; the tests of `base` use `top`.
    fn three() -> CratesOfWorkspace {
        let all = [
            ("phihat-model", package("crates/phihat-model/", &[], &["top"])),
            ("middle", package("crates/middle/", &["phihat-model"], &[])),
            ("top", package("crates/top/", &["middle"], &[])),
        ];
        all.into_iter().map(|(name, package)| (name.to_owned(), package)).collect()
    }

    fn set(names: &[&str]) -> BTreeSet<String> {
        names.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn files_belong_to_the_crate_around_them() {
        let workspace = three();
        assert_eq!(crate_of(&workspace, "crates/middle/src/lib.rs"), Some("middle"));
        assert_eq!(crate_of(&workspace, "crates/phihat-model/robots/a.urdf"), Some("phihat-model"));
        assert_eq!(crate_of(&workspace, "README.md"), None);
        let files = ["crates/top/a.rs", "crates/top/b.rs", "docs/x.md"].map(str::to_owned);
        assert_eq!(changed_crates(&workspace, &files), set(&["top"]));
    }

    #[test]
    fn tests_that_build_half_the_workspace_again_are_left_out_and_told() {
        let workspace = three();
        assert_eq!(users(&workspace, &set(&["phihat-model"])), set(&["middle", "top"]));
        let changed = set(&["middle", "phihat-model"]);
        let (tested, circular) = testable(&workspace, &changed);
        assert_eq!((tested, &circular), (set(&["middle"]), &set(&["phihat-model"])));
        let files = ["Cargo.lock".to_owned(), "docs/x.md".to_owned()];
        let edited = ["crates/middle/tests/laws.rs".to_owned(), "crates/top/tests/x.rs".to_owned()];
        assert_eq!(edited_tests(&workspace, &edited), [("middle", "laws")]);
        let told = left_out(&workspace, &edited, &set(&["middle"]), &set(&[])).join("\n");
        assert!(!told.contains("laws"), "{told}");
        let lines = left_out(&workspace, &files, &changed, &circular).join("\n");
        for word in ["unit tests of phihat-model", "laws", "top", "Cargo.lock", "docs/x.md"] {
            assert!(lines.contains(word), "{word}: {lines}");
        }
    }
}
