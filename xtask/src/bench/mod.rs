//! `cargo xtask bench`: our dynamics and Pinocchio's, side by side on this machine; and many arms at once,
//! alongside MuJoCo's rollouts.
//!
//! All sides are built here with the machine's full instruction set, pinned to one core, and run in
//! alternation, so that a slow minute of the machine meets all. Each run prints one median per
//! algorithm; the table shows the best of the rounds' medians and how far the rounds spread.
#![allow(clippy::print_stdout, reason = "a chore of the terminal: its table is the product")]

mod figures;
mod history;
mod machine;
mod peer;
mod places;

use std::path::Path;
use std::process::Command;

use figures::BenchSides;
use machine::BenchMachine;
use peer::Peer;
use places::{BenchPlaces, output, write};

const USAGE: &str = "usage: cargo xtask bench [--quick] [--keep] [--cxx COMPILER]";
const ROUNDS: usize = 5;

/// Our bench binaries that print figures: package and bench.
const OWN: [(&str, &str); 3] =
    [("phihat-model", "dynamics"), ("phihat", "update"), ("phihat-sim", "closed_loop")];

/// Measures both sides, prints the table, and writes `target/bench/bench.json`.
pub(crate) fn run(args: &[String]) -> Result<(), String> {
    let options = BenchOptions::parse(args)?;
    let places = BenchPlaces::find()?;
    let benches = present(&places.root);
    for (package, bench) in &benches {
        output(cargo_bench(&places.root, package, bench).arg("--no-run"))?;
    }
    let peer = Peer::build(&places, options.cxx.as_deref())?;
    let machine = BenchMachine::inspect(&places.root);

    let mut sides = BenchSides::default();
    for round in 1..=options.rounds {
        println!("round {round} of {}", options.rounds);
        sides.peer.add(&output(&mut machine.pin(peer.command(options.quick)))?)?;
        sides.mujoco.add(&output(&mut machine.pin(peer.rollouts(options.quick)))?)?;
        for (package, bench) in &benches {
            let mut command = cargo_bench(&places.root, package, bench);
            if options.quick {
                command.args(["--", "--quick"]);
            }
            sides.ours.add(&output(&mut machine.pin(command))?)?;
        }
    }

    print!("\n{}{}\n{}", machine.text(), peer.text(), sides.table(options.rounds));
    let file = places.output.join("bench.json");
    let document = serde_json::json!({
        "machine": machine.json(),
        "pinocchio": peer.json(),
        "rounds": options.rounds,
        "figures": sides.json(),
    });
    write(&file, &format!("{document:#}\n"))?;
    println!("\nwritten: {}", file.display());
    if options.keep {
        history::keep(&places.root, &document, &machine::date(&places.root))
    } else {
        Ok(())
    }
}

struct BenchOptions {
    quick: bool,
    /// Puts the figures at the end of those that the repository keeps.
    keep: bool,
    rounds: usize,
    cxx: Option<String>,
}

impl BenchOptions {
    fn parse(args: &[String]) -> Result<Self, String> {
        let mut options = Self { quick: false, keep: false, rounds: ROUNDS, cxx: None };
        let mut rest = args.iter();
        while let Some(word) = rest.next() {
            match word.as_str() {
                "--quick" => (options.quick, options.rounds) = (true, 1),
                "--keep" => options.keep = true,
                "--cxx" => options.cxx = Some(rest.next().ok_or(USAGE)?.clone()),
                other => return Err(format!("unknown argument `{other}`\n{USAGE}")),
            }
        }
        Ok(options)
    }
}

/// The benches of [`OWN`] that exist; says which do not.
fn present(root: &Path) -> Vec<(&'static str, &'static str)> {
    let (there, missing): (Vec<_>, Vec<_>) = OWN.iter().partition(|(package, bench)| {
        root.join("crates").join(package).join("benches").join(bench).with_extension("rs").exists()
    });
    for (package, bench) in missing {
        println!("skipped: crate {package} has no bench `{bench}`");
    }
    there
}

fn cargo_bench(root: &Path, package: &str, bench: &str) -> Command {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(root).args(["bench", "--quiet", "-p", package, "--bench", bench]);
    command
}
