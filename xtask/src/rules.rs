//! House rules that a machine can check: arrows between crates, forbidden words, the bare core.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{arrows, dependencies, files, labels};

/// Words that do not belong into the project, and what does.
const WORDS: [(&str, &str); 4] = [
    ("TODO", "an issue, named in a sentence"),
    ("FIXME", "an issue, named in a sentence"),
    ("#[ignore", "a test that asserts today's behaviour and says so"),
    ("unimplemented!", "an error value"),
];

/// Texts that may only become fewer, with the number of lines of code outside of tests' files that have them.
const COUNTED: [(&str, usize); 2] = [("unsafe ", 77), ("[allow(", 70)];

/// Names of a part of one form of the law, and the largest number of sources that may have them: those that store, show
/// or seek gains. What computes a claim has the law's linear system in its place.
const FILTER: [&str; 4] =
    ["innovation_filter", "InnovationSection", "FilterSection", "SECTIONS_MAX"];
const FILTER_SOURCES: usize = 38;
const CLAIMING: [&str; 5] = [
    "crates/phihat-certificate/src/coupled/",
    "crates/phihat-certificate/src/tube/",
    "crates/phihat-design/src/coupled/",
    "crates/phihat-design/src/sampled/",
    "crates/phihat-design/src/tube/",
];

/// Returns true if a source names the filter on the innovation, its tests aside.
fn names_filter(name: &str, text: &str) -> bool {
    let code = text.lines().take_while(|line| line.trim() != "#[cfg(test)]");
    let mut code = code.filter(|line| !line.trim_start().starts_with("//"));
    name.contains("/src/") && code.any(|line| FILTER.iter().any(|word| line.contains(word)))
}

/// Words that no doc comment begins with: its first line is a noun phrase or a verb phrase.
const QUESTIONS: [&str; 3] = ["What ", "Whether ", "How "];

/// Sources whose doc comments are the help of a program.
const HELP: &str = "crates/phihat-cli/src/";

/// Most characters of a line.
const LINE_MAX: usize = 120;

/// Text of a line of doc comment.
fn doc(line: &str) -> Option<&str> {
    let line = line.trim_start();
    line.strip_prefix("///").or(line.strip_prefix("//!")).map(str::trim_start)
}

/// Lines that break the two rules above. Rows of tables and addresses may be longer.
fn lines(name: &str, text: &str) -> Vec<String> {
    let (mut wrong, mut before) = (Vec::new(), None::<&str>);
    for (number, line) in text.lines().enumerate() {
        let at = format!("{name}:{}", number + 1);
        let now = doc(line);
        if let (Some(first), None) = (now, before)
            && QUESTIONS.iter().any(|word| first.starts_with(word))
            && !name.starts_with(HELP)
        {
            wrong.push(format!("{at}: a doc comment begins with a noun or a verb"));
        }
        let unbreakable =
            line.contains("http") || line.trim_start_matches([' ', '/', '!']).starts_with('|');
        if !unbreakable && line.chars().count() > LINE_MAX {
            wrong.push(format!("{at}: a line has at most {LINE_MAX} characters"));
        }
        before = now;
    }
    wrong
}

/// Sources in which no number may be passed over: what claims, checks or lets an arm run.
const GATES: [&str; 5] = [
    "crates/phihat-certificate/src/",
    "crates/phihat-design/src/",
    "crates/phihat-model/src/",
    "crates/phihat-session/src/",
    "crates/phihat-synthesis/src/",
];

/// Lines on which a `fold` or `reduce` begins that takes `f64::min` or `max` of something.
fn folds_that_drop_nan(text: &str) -> Vec<usize> {
    let mut found = Vec::new();
    for call in [".fold(", ".reduce("] {
        for (at, _) in text.match_indices(call) {
            let inside = &text[at + call.len()..];
            let mut depth = 1_u32;
            let end = inside.find(|c| {
                match c {
                    '(' => depth += 1,
                    ')' => depth -= 1,
                    _ => {}
                }
                depth == 0
            });
            let inside = &inside[..end.unwrap_or(inside.len())];
            if [".min(", ".max(", "f64::min", "f64::max"].iter().any(|word| inside.contains(word)) {
                found.push(text[..at].matches('\n').count() + 1);
            }
        }
    }
    found.sort_unstable();
    found
}

/// Calls that only the one way to the disk may make, so that a test can have any of them fail; and the file
/// of that way.
const WRITERS: [&str; 6] = [
    "fs::write(",
    "File::create",
    "OpenOptions",
    "fs::rename(",
    "fs::remove_file(",
    "fs::create_dir",
];
const WRITING: [&str; 5] = [
    "crates/phihat-session/src/",
    "crates/phihat-campaign/src/",
    "crates/phihat-compare/src/",
    "crates/phihat-paper/src/",
    "crates/phihat-cli/src/",
];
const DISK: [&str; 2] =
    ["crates/phihat-session/src/disk/", "crates/phihat-campaign/src/journal.rs"];

/// Lines of a file of results' writers that go past the one way to the disk; its tests may.
fn past_the_disk(name: &str, text: &str) -> Vec<String> {
    let starts = |all: &[&str]| all.iter().any(|start| name.starts_with(start));
    if !starts(&WRITING) || starts(&DISK) {
        return Vec::new();
    }
    let code = text.lines().take_while(|line| line.trim() != "#[cfg(test)]").enumerate();
    let writes = code.filter(|(_, line)| WRITERS.iter().any(|word| line.contains(word)));
    writes
        .map(|(k, line)| {
            format!("{name}:{}: {}; write by phihat_session::disk", k + 1, line.trim())
        })
        .collect()
}

/// Checks arrows, words, folds, writers, labels, and that every crate but the C binding forbids `unsafe`.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let mut wrong = arrows::wrong(root)?;
    wrong.extend(dependencies::wrong(root)?);
    wrong.extend(files::wrong(root)?);
    wrong.extend(labels::wrong(root)?);
    wrong.extend(tests_left_out(root)?);
    let mut counts = [0_usize; COUNTED.len()];
    let mut filter_sources = 0;
    for file in sources(root)? {
        let text = fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        let name = file.strip_prefix(root).unwrap_or(&file).display().to_string();
        if name == "xtask/src/rules.rs" {
            continue;
        }
        for (number, line) in text.lines().enumerate() {
            for (word, instead) in WORDS {
                if line.contains(word) {
                    wrong.push(format!("{name}:{}: {word}; write {instead}", number + 1));
                }
            }
        }
        if GATES.iter().any(|gate| name.starts_with(gate)) {
            for line in folds_that_drop_nan(&text) {
                let why = "a fold by min or max passes over NaN; use phihat_certificate::extremes";
                wrong.push(format!("{name}:{line}: {why}"));
            }
        }
        for (count, (word, _)) in counts.iter_mut().zip(COUNTED) {
            if !name.contains("/src/") {
                continue;
            }
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            *count += code.filter(|line| line.contains(word)).count();
        }
        if names_filter(&name, &text) {
            filter_sources += 1;
            if CLAIMING.iter().any(|folder| name.starts_with(folder)) {
                wrong.push(format!("{name}: a claim is computed from `JointGains::linear`"));
            }
        }
        wrong.extend(past_the_disk(&name, &text));
        wrong.extend(lines(&name, &text));
        let c_binding = name.starts_with("crates/phihat-c/");
        let is_root = name.ends_with("src/lib.rs") || name.ends_with("src/main.rs");
        if is_root && !c_binding && !text.contains("#![forbid(unsafe_code)]") {
            wrong.push(format!("{name}: a crate says #![forbid(unsafe_code)]"));
        }
    }
    for (count, (word, most)) in counts.into_iter().zip(COUNTED) {
        if count > most {
            wrong.push(format!(
                "{count} lines with {word:?}, where {most} were: do without the new one"
            ));
        }
    }
    if filter_sources > FILTER_SOURCES {
        let (now, most) = (filter_sources, FILTER_SOURCES);
        wrong.push(format!("{now} sources name the innovation filter, where {most} did"));
    }
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// Files beside the one program of a crate's tests that it does not name: they would never run.
fn tests_left_out(root: &Path) -> Result<Vec<String>, String> {
    let mut wrong = Vec::new();
    for file in sources(root)?.iter().filter(|file| file.ends_with("tests/main.rs")) {
        let folder = file.parent().unwrap_or(root);
        let text = fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
        for entry in fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            let path = entry.map_err(|e| e.to_string())?.path();
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let is_test = path.extension().is_some_and(|e| e == "rs") && name != "main";
            if is_test && !text.lines().any(|line| line == format!("mod {name};")) {
                let place = path.strip_prefix(root).unwrap_or(&path).display();
                wrong
                    .push(format!("{place}: runs where `mod {name};` stands in main.rs beside it"));
            }
        }
    }
    Ok(wrong)
}

fn sources(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    let mut folders = vec![root.join("crates"), root.join("examples/rust"), root.join("xtask")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            let path = entry.map_err(|e| e.to_string())?.path();
            let skip = ["target", "node_modules"].iter().any(|n| path.ends_with(n));
            if path.is_dir() && !skip {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// Compiles every entry point of the core without link-time optimisation and reads the object files:
/// no undefined symbol may lead to a panic or an allocator.
pub(crate) fn core_is_bare(root: &Path) -> Result<(), String> {
    let target = root.join("target/bare");
    let compile = |what: &[&str]| {
        let status = Command::new("cargo")
            .args(["rustc", "--quiet", "--release", "-p", "phihat"])
            .args(what)
            .args(["--", "--emit=obj"])
            .env("CARGO_PROFILE_RELEASE_LTO", "off")
            .env("CARGO_TARGET_DIR", &target)
            .current_dir(root)
            .status()
            .map_err(|e| e.to_string())?;
        if status.success() { Ok(()) } else { Err("the core does not compile".to_owned()) }
    };
    if target.exists() {
        fs::remove_dir_all(&target).map_err(|e| e.to_string())?;
    }
    compile(&["--lib"])?;
    compile(&["--example", "freestanding"])?;
    let mut seen = 0;
    for folder in ["release/deps", "release/examples"] {
        for entry in fs::read_dir(target.join(folder)).map_err(|e| e.to_string())? {
            let path = entry.map_err(|e| e.to_string())?.path();
            if path.extension().is_some_and(|e| e == "o") {
                seen += inspect(&path)?;
            }
        }
    }
    // The check must be able to fail: both object files, with the entry points in them.
    if seen < 41 {
        Err(format!("only {seen} entry points found in the object files"))
    } else {
        Ok(())
    }
}

/// Number of the core's entry points in an object file.
fn inspect(object: &Path) -> Result<usize, String> {
    let output = Command::new("nm")
        .arg("-C")
        .arg(object)
        .output()
        .map_err(|e| format!("nm cannot be started: {e}"))?;
    let symbols = String::from_utf8_lossy(&output.stdout);
    let bad = ["panic", "alloc", "unwrap_failed", "expect_failed"];
    let undefined = symbols.lines().filter(|line| line.trim_start().starts_with("U "));
    if let Some(symbol) = undefined.clone().find(|s| bad.iter().any(|b| s.contains(b))) {
        return Err(format!("the core refers to {}", symbol.trim()));
    }
    Ok(symbols.lines().filter(|line| line.contains(" T freestanding::")).count())
}

/// Packs every library crate and the command as a registry would get them; with `built`, builds each from its
/// package alone.
pub(crate) fn packages(root: &Path, built: bool) -> Result<(), String> {
    let names = arrows::PUBLISHED.iter().flat_map(|name| ["--package", name]);
    let line = ["package", "--quiet", "--allow-dirty"].into_iter().chain(names);
    let line: Vec<&str> = line.chain((!built).then_some("--no-verify")).collect();
    crate::shell::cargo(root, &line)
}

#[cfg(test)]
mod tests {
    use super::{lines, names_filter, tests_left_out};
    use std::fs;

    #[test]
    fn comments_begin_with_a_noun_or_a_verb_and_fit_their_line() {
        let wrong = |text: &str| lines("crates/one/src/lib.rs", text).len();
        assert_eq!(wrong("/// Number of joints.\n/// What is more: none.\nfn a() {}\n"), 0);
        assert_eq!(wrong("//! What a joint has.\n\n/// Whether it moves.\nfn a() {}\n"), 2);
        assert_eq!(wrong(&format!("// {}\n// |{0}|\n", "x".repeat(118))), 1);
        assert_eq!(lines("crates/phihat-cli/src/run.rs", "/// What is run.\n").len(), 0);
    }

    #[test]
    fn a_source_names_the_filter_by_its_code() {
        let names = |text: &str| names_filter("crates/one/src/lib.rs", text);
        assert!(names("fn a(of: &FilterSection) {}\n"));
        assert!(!names("// A FilterSection\n#[cfg(test)]\nmod tests { use x::FilterSection; }\n"));
        assert!(!names_filter("crates/one/tests/a.rs", "use x::FilterSection;\n"));
    }

    #[test]
    fn a_test_that_nobody_runs_is_told() {
        let root = std::env::temp_dir().join(format!("left-out-{}", std::process::id()));
        let folder = root.join("crates/one/tests");
        for other in ["examples/rust", "xtask"] {
            fs::create_dir_all(root.join(other)).unwrap();
        }
        fs::create_dir_all(&folder).unwrap();
        for (name, text) in [("main.rs", "mod run;\n"), ("run.rs", ""), ("idle.rs", "")] {
            fs::write(folder.join(name), text).unwrap();
        }
        let told = tests_left_out(&root).unwrap();
        fs::remove_dir_all(&root).unwrap();
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].starts_with("crates/one/tests/idle.rs"), "{told:?}");
    }
}
