//! The `phihat` command: from a study to evidence.
#![forbid(unsafe_code)]
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command line speaks to a terminal"
)]

mod design;
mod failure;
mod files;
mod record;
mod report;
mod robots;
mod run;
mod simulate;
mod table;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::failure::Failure;

/// Control a robot arm by torque, without a model of it, and see the evidence.
///
/// A study (TOML) states the arm, the error you can live with, the loop and the world. `phihat run` takes
/// it through gains, a closed loop and a report.
#[derive(Debug, Parser)]
#[command(
    name = "phihat",
    version,
    after_help = "Exit codes: 0 done and within spec · 1 done, but a bound was exceeded or the run \
                  diverged · 2 the input cannot be used.\n\nExample:\n  phihat run studies/first.toml"
)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Run(run::Run),
    Design(design::Design),
    Verify(verify::Verify),
    Simulate(simulate::Simulate),
    Report(report::Report),
    Robots(robots::Robots),
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().verb {
        Verb::Run(run) => run.execute(),
        Verb::Design(design) => design.execute(),
        Verb::Verify(verify) => verify.execute(),
        Verb::Simulate(simulate) => simulate.execute(),
        Verb::Report(report) => report.execute(),
        Verb::Robots(robots) => robots.execute(),
    };
    outcome.unwrap_or_else(|failure: Failure| {
        eprintln!("{failure}");
        ExitCode::from(2)
    })
}
