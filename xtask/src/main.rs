//! The project's chores: `cargo xtask check | test | attack | fuzz | mutants | twice | bench | bless`.
#![forbid(unsafe_code)]
#![allow(clippy::print_stderr, clippy::print_stdout, reason = "a chore speaks to a terminal")]
#![allow(clippy::disallowed_methods, reason = "a chore tells how long it took")]

mod arrows;
mod attack;
mod bench;
mod bindings;
mod bless;
mod book;
mod browser;
mod check;
mod dependencies;
mod dist;
mod exact;
mod files;
mod forge;
mod franka;
mod fuzz;
mod gate;
mod instructions;
mod labels;
mod laws;
mod live_book;
mod mutants;
mod pages;
mod programs;
mod ray;
mod rivals;
mod ros2;
mod rules;
mod screenshots;
mod shell;
mod shown;
mod stops;
mod theory;
mod tools;
mod trusted;
mod twice;
mod venv;
mod verbs;
mod web;
mod zoo;

use std::process::ExitCode;

const USAGE: &str = "usage:
  cargo xtask check            within a minute after an edit: format, house rules, and of the crates that differ from
                               HEAD the lints, the unit tests and the tests that were edited; ends with what it left out
  cargo xtask test [STEP …]    the gate: everything that an edit can break, in a quarter of an hour; or the steps \
  whose name contains STEP
  cargo xtask test --all       the gate, then the long campaigns (hours); with --keep, the processor times become \
  those that later runs
                               are compared with (xtask/times.json)
  cargo xtask attack [N] [--seed S] [--jobs J] [--json FILE] [--alone]
                               N random studies that try to break what is certified about them (resumes);
                               one in twenty also in Pinocchio and MuJoCo, unless --alone
  cargo xtask forge [N] [--seed S] [--derive-every K]
                               N edits of the gains of each of three shipped studies (resumes): refused by `phihat \
  verify`, or no more said
  cargo xtask fuzz [MINUTES]   documents and samples that nobody would write, against every reader and the core
  cargo xtask mutants [--shard K/N] [FILE …]
                               changes the core in one place at a time and counts what no test notices (hours; K from \
                               0);
                               files of phihat-kernel or phihat-certificate: its mutants
  cargo xtask twice [PACKAGE]  builds what is committed in two folders and compares the bytes
  cargo xtask dist             makes what a release consists of in target/dist: the command for the baseline \
  processor, a wheel, source
                               packages, their hashes (minutes)
  cargo xtask theory           one PDF of docs/theory, target/theory/theory.pdf
  cargo xtask packages         packs every library crate and builds each from its package alone (minutes)
  cargo xtask arrows           writes which crate may use which into ARCHITECTURE.md
  cargo xtask trusted [FOLDER] lines of code that each claim rests on, into docs/theory/exact.md; those of \
  another checkout
  cargo xtask bench [--quick] [--keep]
                               dynamics, core and closed loop, side by side with Pinocchio and MuJoCo; --keep puts a \
                               line into
                               docs/speed.md
  cargo xtask verbs [--beside PROGRAM] [--rounds N]
                               what the verbs that people wait for take, and another program's beside them, in turns \
                               (a minute)
  cargo xtask soak [SAMPLES]   a billion samples, every pattern of 32 bits (minutes)
  cargo xtask exact [LAWS]     linear claims of so many random laws (1,000: minutes): where the kernel says that each \
  ends, decided
                               again in FLINT's exact and ball arithmetic, on both sides
  cargo xtask stops [N]        N stops of random coupled arms and N of the repository's arms, under pushes, drops, \
  lost samples, lies and reversed drives (10,000: six minutes)
  cargo xtask rivals           counts the instructions of every rival's update, for `phihat compare`
  cargo xtask table1           the full comparison of rivals, kept in docs/comparison (half an hour; resumes)
  cargo xtask fronts           a part of the comparison at equal noise, kept in docs/fronts (three hours; resumes)
  cargo xtask laws [arms|worlds] [ARM …] [--json FILE] [--fresh]
                               laws from positions against laws fed with velocity: least certified errors, and worlds
                               that differ; all of it is kept in docs/laws.md (half an hour; resumes)
  cargo xtask zoo [--only NAME] [--no-run] [--jobs N] [--timeout S] [--within S] [--any-build] [--folder FOLDER] \
  [--fresh] [--debug]
                               other people's descriptions of arms: which load, whether Pinocchio finds the same \
                               torque, what
                               `phihat new` and `phihat run` make of them; kept in docs/zoo.md (hours; resumes)
  cargo xtask web [--only-build | --every-study]
                               phihat as a page for a browser, target/web/page, and in the book,
                               target/web/book, tried in Chromium (minutes)
  cargo xtask screenshots [OUT [PAGE …]]
                               pictures of every page, of further ones and of the studio, to be looked at: 1300 and \
                               390 px wide, light,
                               dark and as they print (minutes)
  cargo xtask franka           `phihat drive` on a Franka that somebody else simulates, by the clock: a motion, a \
  pause that is borne, one
                               that is not, a jump (minutes)
  cargo xtask drive-cost       counts the instructions of a cycle of the control thread of `phihat drive`
  cargo xtask ros2             `phihat drive --ros2` beside another DDS: every kind of message both ways, counts \
  compared (half a minute
                               beyond the build, which compiles DDS)
  cargo xtask ray              `phihat.sweep` on a cluster of Ray on this machine, a worker and a node killed \
  half-way: the same bytes; and
                               the times that tools/schedule.py reckons with (minutes)
  cargo xtask bless [book]     the README's output, the book's page of commands and figures, and docs/reproduction,
                               as they are now; book: those of the book only";

fn main() -> ExitCode {
    let words: Vec<_> = std::env::args_os().skip(1).collect();
    if words.first().is_some_and(|word| word == "measured") {
        return gate::measured(&words[1..]).unwrap_or_else(|why| {
            eprintln!("{why}");
            ExitCode::FAILURE
        });
    }
    let args: Vec<String> = words.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    let result = match args.split_first() {
        Some((verb, rest)) if verb == "test" => gate::run(rest),
        Some((verb, _)) if verb == "check" => check::run(&shell::root()),
        Some((verb, _)) if verb == "packages" => rules::packages(&shell::root(), true),
        Some((verb, _)) if verb == "dist" => dist::run(&shell::root()),
        Some((verb, _)) if verb == "theory" => theory::pdf(&shell::root()),
        Some((verb, _)) if verb == "arrows" => arrows::bless(&shell::root()),
        Some((verb, rest)) if verb == "trusted" => trusted::run(&shell::root(), rest),
        Some((verb, rest)) if verb == "bless" => match rest.first().map(String::as_str) {
            None => bless::run(&shell::root()),
            Some("book") => book::bless(&shell::root()),
            Some(_) => Err(USAGE.to_owned()),
        },
        Some((verb, rest)) if verb == "web" => web::run(&shell::root(), rest),
        Some((verb, _)) if verb == "table1" => bless::comparison(&shell::root()),
        Some((verb, _)) if verb == "fronts" => bless::fronts(&shell::root()),
        Some((verb, rest)) if verb == "screenshots" => {
            programs::note(&shell::root()).and_then(|()| screenshots::run(&shell::root(), rest))
        }
        Some((verb, rest)) if verb == "franka" => franka::run(&shell::root(), rest),
        Some((verb, _)) if verb == "drive-cost" => instructions::drive(&shell::root()),
        Some((verb, rest)) if verb == "ros2" => ros2::run(&shell::root(), rest),
        Some((verb, rest)) if verb == "ray" => ray::run(&shell::root(), rest),
        Some((verb, rest)) if verb == "zoo" => zoo::run(&shell::root(), rest),
        Some((verb, rest)) if verb == "laws" => laws::run(&shell::root(), rest),
        Some((verb, _)) if verb == "rivals" => rivals::run(&shell::root()),
        Some((verb, rest)) if verb == "soak" => {
            let samples = rest.first().map_or("1000000000", String::as_str);
            let bench = ["bench", "--quiet", "-p", "phihat", "--bench", "soak", "--", samples];
            shell::cargo(&shell::root(), &bench)
        }
        Some((verb, rest)) if verb == "exact" => exact::run(&shell::root(), rest),
        Some((verb, rest)) if verb == "stops" => stops::run(&shell::root(), rest),
        Some((verb, rest)) if verb == "mutants" => mutants::run(&shell::root(), rest),
        Some((verb, rest)) if verb == "twice" => {
            twice::run(&shell::root(), rest.first().map(String::as_str))
        }
        Some((verb, rest)) if verb == "attack" => attack::run(&shell::root(), rest),
        Some((verb, rest)) if verb == "forge" => forge::run(&shell::root(), rest),
        Some((verb, rest)) if verb == "fuzz" => fuzz::run(&shell::root(), rest.first()),
        Some((verb, rest)) if verb == "bench" => bench::run(rest),
        Some((verb, rest)) if verb == "verbs" => verbs::run(&shell::root(), rest),
        _ => Err(USAGE.to_owned()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("{why}");
            ExitCode::FAILURE
        }
    }
}
