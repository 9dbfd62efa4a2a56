//! `cargo xtask forge [N] [--seed S]`: edits of the shipped studies' gains that try to pass `phihat verify`.

use std::path::Path;

use crate::programs::{note, program};
use crate::shell::command;

/// Studies whose gains are edited: one motion, a whole arm along a motion, and a class of motions.
const STUDIES: [&str; 3] = ["first", "panda_design", "planar_any_signals"];

/// Designs each study and edits its gains N times; further words go to the campaign. It resumes where it stopped;
/// `out/forge/NAME-forged.json` is what came of it.
pub(crate) fn run(root: &Path, arguments: &[String]) -> Result<(), String> {
    note(root)?;
    let place = |name: &str| program(root, name).map(|path| path.display().to_string());
    let (phihat, attack) = (place("phihat-cli/phihat")?, place("phihat-attack/phihat-attack")?);
    let named = arguments.first().is_some_and(|word| !word.starts_with('-'));
    let (count, rest) = if named { arguments.split_at(1) } else { (&[][..], arguments) };
    let count = count.first().map_or("10000", String::as_str);
    for name in STUDIES {
        let study = format!("studies/{name}.toml");
        let (gains, out) = (format!("out/forge/{name}.json"), format!("out/forge/{name}"));
        let summary = format!("out/forge/{name}-forged.json");
        command(root, &phihat, &["--quiet", "design", &study, "--out", &gains])?;
        let mut words =
            vec![count, "--forge", &study, "--gains", &gains, "--out", &out, "--json", &summary];
        words.extend(rest.iter().map(String::as_str));
        command(root, &attack, &words)?;
    }
    Ok(())
}
