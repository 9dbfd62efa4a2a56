//! The `phihat` command: arguments in, tables and exit codes out. Its functions are in [`phihat_session`],
//! and in the crates of the campaigns.
#![forbid(unsafe_code)]
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command line speaks to a terminal"
)]

/// A line on standard output: nothing where phihat is told to be quiet, in colours where there are any.
macro_rules! println {
    ($($words:tt)*) => { $crate::terminal::out(format_args!($($words)*)) };
}

/// A line on standard error, in colours where there are any.
macro_rules! eprintln {
    ($($words:tt)*) => { $crate::terminal::err(format_args!($($words)*)) };
}

mod audit;
mod bound;
mod check;
mod compare;
mod design;
mod drive;
mod editors;
mod export;
mod failure;
mod faults;
mod first_motion;
mod fronts;
mod identify;
mod interrupt;
mod new;
mod numbers;
mod png;
mod proving;
mod realtime;
mod report;
mod reproduce;
mod robots;
mod ros2;
mod run;
mod serve;
mod shown;
mod studio;
mod sweep;
mod table;
mod terminal;
mod verify;
mod xacro;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::failure::Failure;
use crate::terminal::{Color, Manner};

/// Control a robot arm by torque, without a model of it, and see the evidence.
///
/// A study (TOML) states the arm, the error you can live with, the loop and the world. `phihat run` takes
/// it through gains, a closed loop and a report.
#[derive(Debug, Parser)]
#[command(
    name = "phihat",
    version,
    after_help = "Exit codes: 0 done and within spec, also where a torque limit acted (the verdict then says \
                  so) · 1 done, but a bound was exceeded, the run diverged, it left a tube that its \
                  certificate promised, or no gains keep what was asked for · 2 the input cannot be used · 3 gains \
                  that are not proved (design, verify) · 101 phihat \
                  itself failed, which is a bug. With --json a failure is a document too: error, \
                  exit_code.\n\nExample:\n  phihat run studies/first.toml"
)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    manner: Manner,
}

#[derive(Debug, Subcommand)]
enum Verb {
    New(new::New),
    Run(run::RunVerb),
    Design(design::Design),
    Verify(verify::Verify),
    Bound(bound::BoundMotion),
    Export(export::Export),
    Simulate(run::Simulate),
    Drive(drive::DriveVerb),
    Realtime(realtime::Realtime),
    Serve(serve::ServeVerb),
    Studio(studio::StudioVerb),
    Faults(faults::FaultsVerb),
    Sweep(sweep::SweepVerb),
    Merge(sweep::Merge),
    Compare(compare::Compare),
    Fronts(fronts::FrontsVerb),
    Report(report::ReportVerb),
    Reproduce(reproduce::Reproduce),
    Robots(robots::Robots),
    Identify(identify::Identify),
    Audit(audit::AuditVerb),
    Check(check::CheckVerb),
    Schema(editors::Schema),
    Completions(editors::Completions),
    Man(editors::Man),
}

/// A word such as `-1` where an option's value was meant: `-- -1` would make it a study, so that tip is left out.
fn no_tip_about_dashes(error: &mut clap::Error) {
    let is_tip = |value: &ContextValue| matches!(value, ContextValue::StyledStrs(_));
    if error.kind() == ErrorKind::UnknownArgument
        && error.get(ContextKind::Suggested).is_some_and(is_tip)
    {
        error.remove(ContextKind::Suggested);
    }
}

/// Runs the command with the arguments of a process, the program's name first; says how it ended.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    interrupt::is_ours();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let as_json = arguments.iter().any(|word| word == "--json");
    let color = Color::asked(&arguments);
    color.begins();
    // A number below zero is a value that is out of range, no unknown argument.
    let command = || {
        let verbs = Arguments::command().mut_subcommands(|verb| verb.allow_negative_numbers(true));
        verbs.color(color.of_clap())
    };
    let read = command().try_get_matches_from(arguments);
    let verb = match read.and_then(|read| Arguments::from_arg_matches(&read)) {
        Ok(Arguments { verb, manner }) => {
            // A document that was asked for is the answer itself.
            terminal::be_quiet(manner.quiet && !as_json);
            verb
        }
        Err(mut told) => {
            no_tip_about_dashes(&mut told);
            if as_json && told.use_stderr() {
                return Failure::rendered(told.to_string().trim_end()).tell(true);
            }
            // Help goes to standard output, errors to the other; if neither can be written to, so be it.
            let _ = told.print();
            return ExitCode::from(u8::try_from(told.exit_code()).unwrap_or(2));
        }
    };
    failure::guarded(|| execute(verb, command)).unwrap_or_else(|failure| failure.tell(as_json))
}

fn execute(verb: Verb, command: impl FnOnce() -> clap::Command) -> Result<ExitCode, Failure> {
    match verb {
        Verb::New(new) => new.execute(),
        Verb::Run(run) => run.execute(),
        Verb::Design(design) => design.execute(),
        Verb::Verify(verify) => verify.execute(),
        Verb::Bound(bound) => bound.execute(),
        Verb::Export(export) => export.execute(),
        Verb::Simulate(simulate) => simulate.execute(),
        Verb::Drive(drive) => drive.execute(),
        Verb::Realtime(realtime) => realtime.execute(),
        Verb::Serve(serve) => serve.execute(),
        Verb::Studio(studio) => studio.execute(),
        Verb::Faults(faults) => faults.execute(),
        Verb::Sweep(sweep) => sweep.execute(),
        Verb::Merge(merge) => merge.execute(),
        Verb::Compare(compare) => compare.execute(),
        Verb::Fronts(fronts) => fronts.execute(),
        Verb::Report(report) => report.execute(),
        Verb::Reproduce(reproduce) => reproduce.execute(),
        Verb::Robots(robots) => robots.execute(),
        Verb::Identify(identify) => identify.execute(),
        Verb::Audit(audit) => audit.execute(),
        Verb::Check(check) => Ok(check.execute()),
        Verb::Schema(editors::Schema { json: _ }) => Ok(editors::schema()),
        Verb::Completions(completions) => completions.execute(command()),
        Verb::Man(man) => man.execute(command()),
    }
}
