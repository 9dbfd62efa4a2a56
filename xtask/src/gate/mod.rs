//! `cargo xtask test`: the gate, which is everything that an edit can break; with `--all` the long campaigns too.
//!
//! The steps stand in [`steps`]. Steps of one [`GateStage`] run side by side, three at a time, each in a process of
//! its own, so that the processor time of each is measured separately ([`times`]). What a step prints is
//! shown when it has ended.

mod measured;
mod pool;
mod steps;
mod times;

use std::path::Path;
use std::time::Instant;

use crate::shell::root;
use pool::Finished;
use steps::{GateStage, GateStep, Scope};
use times::GateTimes;

pub(crate) use measured::run as measured;

/// Options of `cargo xtask test`.
#[derive(Debug, Default, PartialEq)]
struct GateOptions {
    /// The long campaigns too.
    all: bool,
    /// Writes the measured times into the file of times that the repository keeps.
    keep: bool,
    /// The one step that this process is for.
    step: Option<String>,
    /// Parts of names of steps.
    names: Vec<String>,
}

impl GateOptions {
    fn parse(arguments: &[String]) -> Result<Self, String> {
        let mut options = Self::default();
        let mut words = arguments.iter();
        while let Some(word) = words.next() {
            match word.as_str() {
                "--all" => options.all = true,
                "--keep" => options.keep = true,
                "--step" => {
                    options.step = Some(words.next().ok_or("--step takes a name")?.clone());
                }
                option if option.starts_with('-') => {
                    return Err(format!("{option}: known are --all and --keep"));
                }
                name => options.names.push(name.to_owned()),
            }
        }
        Ok(options)
    }
}

/// Runs the gate, the gate and the campaigns, or the steps whose name contains an argument; stops at the first failure.
pub(crate) fn run(arguments: &[String]) -> Result<(), String> {
    let root = root();
    let options = GateOptions::parse(arguments)?;
    if let Some(name) = &options.step {
        return one(&root, name);
    }
    let stages = chosen(&options)?;
    let began = Instant::now();
    let mut done = Vec::new();
    let program = pool::copy_of_this(&root)?;
    let result = stages.iter().try_for_each(|stage| pool::run(&root, &program, stage, &mut done));
    let wall = began.elapsed().as_secs_f64();
    let costs = done.iter().map(|step| (step.name.to_owned(), step.cost)).collect();
    let times = GateTimes::of(&root, costs, done.iter().any(|step| step.name == steps::TESTS))?;
    print!("{}", times.table(&root, wall)?);
    times.write(&root)?;
    let failed: Vec<&Finished> = done.iter().filter(|step| !step.ok).collect();
    if let Some(first) = failed.first() {
        println!("{} passed, {} failed", done.len() - failed.len(), failed.len());
        return Err(format!("FAILED: {}", first.name));
    }
    result?;
    if options.keep {
        times.keep(&root)?;
    }
    println!("{} passed, 0 failed", done.len());
    Ok(())
}

/// Runs one step in this process; what it and the processes that it started cost is left for the process that waits.
fn one(root: &Path, name: &str) -> Result<(), String> {
    let step = steps::every().find(|step| step.name == name).ok_or_else(unknown)?;
    let began = Instant::now();
    let result = (step.run)(root);
    times::leave(root, name, began.elapsed().as_secs_f64())?;
    result
}

/// The stages with the steps that the options choose; stages without a step are left out.
fn chosen(options: &GateOptions) -> Result<Vec<GateStage>, String> {
    let named =
        |step: &GateStep| options.names.iter().any(|name| step.name.contains(name.as_str()));
    let wanted = |step: &GateStep| match step.scope {
        _ if !options.names.is_empty() => named(step),
        Scope::Gate => true,
        Scope::All => options.all,
    };
    let stages: Vec<GateStage> = steps::STAGES
        .iter()
        .map(|stage| stage.iter().copied().filter(|step| wanted(step)).collect::<GateStage>())
        .filter(|stage| !stage.is_empty())
        .collect();
    if stages.is_empty() { Err(unknown()) } else { Ok(stages) }
}

/// The error for a name that no step has.
fn unknown() -> String {
    let names: Vec<_> = steps::every().map(|step| step.name).collect();
    format!("no step has this name; steps: {}", names.join(" · "))
}

#[cfg(test)]
mod tests {
    use super::{GateOptions, chosen, steps};

    fn options(words: &str) -> Result<GateOptions, String> {
        GateOptions::parse(&words.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
    }

    fn names(words: &str) -> Vec<&'static str> {
        let stages = chosen(&options(words).unwrap()).unwrap();
        stages.into_iter().flatten().map(|step| step.name).collect()
    }

    #[test]
    fn all_is_the_gate_and_more_and_names_choose_from_both() {
        let (gate, all) = (names(""), names("--all"));
        assert!(gate.len() < all.len() && gate.iter().all(|name| all.contains(name)));
        assert_eq!(names("form"), ["format"]);
        let long = all.iter().find(|name| !gate.contains(*name)).unwrap();
        assert!(!names(long.split(' ').next().unwrap()).is_empty());
        assert!(chosen(&options("nothing-is-named-so").unwrap()).is_err());
    }

    #[test]
    fn names_of_steps_are_different_and_name_files() {
        let mut all: Vec<_> = steps::every().map(|step| step.name).collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
        assert!(all.iter().all(|name| !name.contains(['/', '\\', ':'])), "{all:?}");
    }

    #[test]
    fn unknown_options_are_refused() {
        assert!(options("--al").unwrap_err().contains("--al"));
        assert!(options("--step").is_err());
        assert!(options("--all --keep core").unwrap().keep);
    }
}
