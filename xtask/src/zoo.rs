//! `cargo xtask zoo`: descriptions of arms out of four public packages, loaded, held against Pinocchio and run; kept in
//! docs/zoo.md and docs/zoo.json.

use std::path::{Path, PathBuf};

use crate::shell::{cargo, command};
use crate::venv;

/// Python packages of the comparison. Its data are pinned in the script.
const PACKAGES: [&str; 2] = ["numpy==2.4.6", "pin==4.1.0"];

const SCRIPT: &str = "tools/zoo.py";

/// Arguments of the chore; the rest goes to the script.
#[derive(Debug, Default, PartialEq)]
struct ZooOptions {
    folder: Option<PathBuf>,
    no_run: bool,
    debug: bool,
    rest: Vec<String>,
}

impl ZooOptions {
    fn of(arguments: &[String]) -> Result<Self, String> {
        let mut told = Self::default();
        let mut words = arguments.iter();
        while let Some(word) = words.next() {
            let mut value = || {
                let value = words.next().filter(|value| !value.starts_with("--"));
                value.cloned().ok_or(format!("{word} is followed by a value"))
            };
            match word.as_str() {
                "--folder" => told.folder = Some(value()?.into()),
                "--no-run" => told.no_run = true,
                "--debug" => told.debug = true,
                "--fresh" | "--any-build" => told.rest.push(word.clone()),
                "--only" | "--jobs" | "--timeout" | "--within" => {
                    told.rest.extend([word.clone(), value()?]);
                }
                _ => {
                    return Err(format!(
                        "zoo: {word}: [--folder FOLDER] [--only NAME] [--no-run] [--jobs N] [--timeout S] [--within S] \
                            [--any-build] [--fresh] [--debug] are known"
                    ));
                }
            }
        }
        Ok(told)
    }
}

/// Makes what is missing, measures, and keeps the tables; of a part it prints them alone.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    let told = ZooOptions::of(arguments)?;
    let folder = root.join(told.folder.as_deref().unwrap_or(Path::new("target/zoo")));
    let python = venv::python(root, &folder.join("venv"), &PACKAGES)?;
    let place = folder.display().to_string();
    command(root, &python, &[SCRIPT, &place, "--fetch"])?;

    let profile: &[&str] = if told.debug { &[] } else { &["--release"] };
    let built = root.join("target").join(if told.debug { "debug" } else { "release" });
    let program =
        |name: &str| format!("{}{}", built.join(name).display(), std::env::consts::EXE_SUFFIX);
    cargo(
        root,
        &[&["build", "--quiet", "-p", "phihat-model", "--example", "zoo"], profile].concat(),
    )?;
    let (zoo, phihat) = (program("examples/zoo"), program("phihat"));
    let docs = root.join("docs").display().to_string();
    let mut words = vec![SCRIPT, &place, "--zoo", &zoo, "--docs", &docs];
    if !told.no_run {
        cargo(root, &[&["build", "--quiet", "-p", "phihat-cli"], profile].concat())?;
        words.extend(["--phihat", &phihat]);
    }
    words.extend(told.rest.iter().map(String::as_str));
    command(root, &python, &words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(words: &str) -> Result<ZooOptions, String> {
        ZooOptions::of(&words.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn what_is_not_known_or_lacks_its_value_is_refused() {
        let all = told("--folder f --only panda --no-run --jobs 1").unwrap();
        assert_eq!(all.folder.as_deref(), Some(Path::new("f")));
        assert!(all.no_run && !all.debug);
        assert_eq!(all.rest, ["--only", "panda", "--jobs", "1"]);
        assert!(told("--only").unwrap_err().contains("--only is followed"));
        assert!(told("--folder --no-run").unwrap_err().contains("--folder is followed"));
        assert!(told("panda").unwrap_err().contains("panda"));
    }
    #[test]
    fn the_script_counts_and_judges_as_its_examples_say() {
        let output = std::process::Command::new("python3")
            .args(["-m", "doctest", SCRIPT])
            .current_dir(crate::shell::root())
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && told.is_empty(), "{told}");
    }
}
