//! Instructions of one update of every rival, counted by callgrind, into the file that the comparison reads.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use crate::instructions::{build, collected};

/// File from which the comparison reads the counts.
const FILE: &str = "crates/phihat-compare/src/instructions.toml";

/// Arms that are counted on.
const ROBOTS: [&str; 2] = ["planar3r", "panda"];

/// Updates of the shorter and the longer run: what the set-up costs is in both.
const UPDATES: (u32, u32) = (50, 250);

/// Counts every rival on every arm.
pub(crate) fn run(root: &Path) -> Result<(), String> {
    let program = build(root, "phihat-rivals")?;
    let listed = Command::new(&program).arg("list").output().map_err(|e| e.to_string())?;
    let mut text = "# Instructions per update with default gains, counted by callgrind: `cargo xtask rivals`\n\
                    # makes this file again.\n"
        .to_owned();
    for robot in ROBOTS {
        write!(text, "\n[{robot}]\n").map_err(|e| e.to_string())?;
        let each = |id: &str| -> Result<f64, String> {
            let count = |updates: u32| collected(&program, &[robot, id, &updates.to_string()]);
            Ok((count(UPDATES.1)? - count(UPDATES.0)?) / f64::from(UPDATES.1 - UPDATES.0))
        };
        let idle = each("idle")?;
        for id in String::from_utf8_lossy(&listed.stdout).lines() {
            let each = each(id)? - idle;
            // One that was not built, because it does not apply to the arm, does not even loop.
            if each > 0.0 {
                println!("{robot} {id}: {each:.0} instructions per update");
                writeln!(text, "{id} = {each:.0}").map_err(|e| e.to_string())?;
            }
        }
    }
    std::fs::write(root.join(FILE), text).map_err(|e| format!("{FILE}: {e}"))
}
