//! Laws from positions against laws that use a velocity: the least certified error on each arm, and gains
//! that are designed once and run in worlds that differ from their own.
//!
//! `cargo xtask laws`, or
//! `cargo run --release -p phihat-compare --example laws -- [arms|worlds] [ARM] [--json FILE] [--fresh]`.
//! Designs are stored in out/laws; the same command continues from there.
#![forbid(unsafe_code)]
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command speaks to a terminal")]

mod search;
mod studies;
mod tables;
mod work;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use phihat_campaign::{JOURNAL, Journal};
use serde_json::json;

use studies::{ARMS, BITS_16, KINDS, PANDA, study, worlds};
use tables::{ArmRow, Designed, Least, WorldRow};
use work::{Design, first_proved, largest, least_error, run};

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match laws(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::from(2)
        }
    }
}

fn laws(args: &[String]) -> Result<(), Box<dyn Error>> {
    let has = |word: &str| args.iter().any(|arg| arg == word);
    let json = args.iter().position(|arg| arg == "--json").map(|at| args.get(at + 1));
    let json = json.map(|file| file.ok_or("--json is followed by a file")).transpose()?;
    let arms: Vec<_> = ARMS.iter().filter(|arm| has(arm.0)).collect();
    let arms = if arms.is_empty() { ARMS.iter().collect() } else { arms };
    let known = |word: &&String| {
        let words = ["arms", "worlds", "--json", "--fresh"];
        words.contains(&word.as_str()) || ARMS.iter().any(|arm| arm.0 == *word)
    };
    if let Some(word) = args.iter().filter(|word| Some(*word) != json).find(|word| !known(word)) {
        return Err(format!("{word}: [arms|worlds] [ARM …] [--json FILE] [--fresh]").into());
    }
    let folder = Path::new("out/laws");
    let mut journal = Journal::in_folder(&folder.join(JOURNAL), has("--fresh"), &mut ())?;
    let (mut arm_rows, mut designs, mut world_rows) = (Vec::new(), Vec::new(), Vec::new());
    if !has("worlds") {
        for (arm, text) in arms {
            eprintln!("{arm}");
            arm_rows.push(arm_row(&mut journal, arm, text)?);
        }
        println!("{}", tables::arms(&arm_rows));
    }
    if !has("arms") {
        eprintln!("the Panda in worlds");
        (designs, world_rows) = in_worlds(&mut journal)?;
        println!("{}\n{}", tables::designs(&designs), tables::worlds(&world_rows));
    }
    if let Some(file) = json {
        let all = json!({ "arms": arm_rows, "designs": designs, "worlds": world_rows });
        phihat_session::files::write(Path::new(file), &format!("{all:#}\n"))?;
    }
    Ok(())
}

/// The least certified error of each kind of law on an arm.
fn arm_row(journal: &mut Journal, arm: &str, text: &str) -> Result<ArmRow, Box<dyn Error>> {
    let mut kinds = Vec::new();
    for kind in &KINDS {
        let (best, tried) = least_error(journal, (text, kind))?;
        let ran = |design: &Design| {
            design.gains.as_ref().ok().map(|gains| run(study(text, kind, &[])?, gains)).transpose()
        };
        kinds.push(Least {
            kind: kind.name.to_owned(),
            errors: best.as_ref().and_then(Design::errors),
            step: best.as_ref().and_then(Design::steps).as_deref().map(largest),
            tried,
            run: best.as_ref().map(ran).transpose()?.flatten(),
        });
    }
    let allowed = study(text, &KINDS[0], &[])?.design.torque_step_max.unwrap_or_default();
    Ok(ArmRow { arm: arm.to_owned(), step_allowed: largest(&allowed), kinds })
}

/// The Panda, with gains designed once, in worlds that differ.
fn in_worlds(journal: &mut Journal) -> Result<(Vec<Designed>, Vec<WorldRow>), Box<dyn Error>> {
    let mut told = Vec::new();
    let mut of = |edits: &[studies::Edit<'_>], bits: u32| -> Result<Vec<Design>, Box<dyn Error>> {
        let mut all = Vec::new();
        for kind in &KINDS {
            let design = first_proved(journal, (PANDA, kind), edits)?;
            let certificate = design.gains.as_ref().ok().and_then(|all| all.certificate.as_ref());
            told.push(Designed {
                kind: kind.name.to_owned(),
                bits,
                asked: design.asked,
                proved: design.proved(),
                errors: design.errors(),
                unproved: certificate.map(|all| all.unproved.clone()).unwrap_or_default(),
            });
            all.push(design);
        }
        Ok(all)
    };
    let fine = of(&[], 18)?;
    let coarse = of(&[BITS_16], 16)?;
    let mut rows = Vec::new();
    let mut all: Vec<_> = worlds()?.into_iter().map(|(name, edits)| (name, edits, &fine)).collect();
    all.push(("16 bits, designed for them", vec![BITS_16], &coarse));
    for (world, edits, designs) in all {
        let mut runs = Vec::new();
        for (kind, design) in KINDS.iter().zip(designs) {
            let ran = |gains| run(study(PANDA, kind, &edits)?, gains);
            runs.push(design.gains.as_deref().ok().map(ran).transpose()?);
        }
        rows.push(WorldRow { world: world.to_owned(), runs });
    }
    Ok((told, rows))
}
