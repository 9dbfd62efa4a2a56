//! Workload of `cargo xtask drive-cost` under callgrind: cycles of the control thread of a drive, a Panda
//! with its supervisor. Arguments: `CLASS SAMPLES`; `robot VERSION` is the other end of the classes that use
//! a network, a process of its own, which is not counted.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a benchmark stops on a bad set-up")]

#[path = "../tests/support/mod.rs"]
mod support;

use std::io::{BufRead as _, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use phihat::Released;
use phihat_design::requested_gains;
use phihat_drive::{
    Clock, Desk, End, Facts, FrankaAddress, FrankaLink, Link, LinkFault, Order, Plan, SimLink,
    Wait, cycles, ring,
};
use phihat_fci::Protocol;
use phihat_sim::{ControlSide, Sample, Simulation, WorldSide};
use phihat_study::Study;
use support::served::{self, DRIVEN, Served};
use support::{PANDA, names, study};

/// The loop over a link that costs nothing; and over both versions of the Franka Control Interface.
const CLASSES: [&str; 3] = ["loop", "fci5", "fci10"];

fn sides() -> (Study, ControlSide, WorldSide) {
    let study = study(&format!("duration_s = 60.0\nseed = 5\n{PANDA}{DRIVEN}"));
    let gains = requested_gains(&study).unwrap();
    let control = &study.control;
    let law = gains.joint_gains(&names(&study), control.period_ns, control.form).unwrap();
    let (control, world) = Simulation::new(&study, &law).unwrap().apart();
    (study, control, world)
}

/// An arm that is always where it began: its samples are made before anything is counted.
struct Still {
    facts: Facts,
    sample: Sample,
    t_ns: u64,
}

impl Link for Still {
    fn facts(&self) -> &Facts {
        &self.facts
    }

    fn start(&mut self) -> Result<(), LinkFault> {
        Ok(())
    }

    fn wait(&mut self, sample: &mut Sample) -> Wait {
        self.sample.sequence += 1;
        sample.take(&self.sample);
        self.t_ns += self.facts.period_ns;
        Wait::Fresh { t_ns: self.t_ns - self.facts.period_ns }
    }

    fn send(&mut self, tau: Released<'_, f64>) {
        std::hint::black_box(tau.tau());
    }

    fn finish(&mut self, _: Released<'_, f64>) -> Result<(), LinkFault> {
        Ok(())
    }

    fn recover(&mut self) -> Result<(), LinkFault> {
        Err(LinkFault::NoRecovery)
    }
}

fn still(study: &Study, world: &mut WorldSide) -> Still {
    let facts = SimLink::facts_of(study, Clock::LockStep);
    let sample = world.sense().unwrap().sample.clone();
    Still { facts, sample, t_ns: 0 }
}

/// The other end in a process of its own, and its address.
fn robot(version: &str) -> (Child, FrankaAddress) {
    let program = std::env::current_exe().unwrap();
    let spawned = Command::new(program).args(["robot", version]).stdout(Stdio::piped()).spawn();
    let mut child = spawned.unwrap();
    let mut host = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut host).unwrap();
    let protocol = Protocol::of_version(version.parse().unwrap());
    let (host, patience) = (host.trim().to_owned(), Duration::from_mins(1));
    (child, FrankaAddress { host, protocol, patience })
}

fn driven<L: Link>(mut link: L, (study, mut control): (&Study, ControlSide), samples: u64) {
    let mut desk = Desk::new(Order::new(&names(study), None, 7).unwrap(), 7);
    let room = usize::try_from(samples).unwrap();
    let (mut tape, _reader) = ring(7, room, true);
    let stop = AtomicBool::new(false);
    let plan = Plan {
        samples,
        stop_samples: 1,
        stop: &stop,
        fault_samples: None,
        targets: None,
        park: None,
    };
    link.start().unwrap();
    let tally = cycles(&mut link, &mut control, &mut tape, &mut desk, &plan);
    assert_eq!((tally.end, tally.cycles), (End::Complete, samples));
}

fn count(class: &str, samples: u64) {
    let (study, control, mut world) = sides();
    match class {
        "loop" => driven(still(&study, &mut world), (&study, control), samples),
        wire => {
            let (mut child, address) = robot(wire.trim_start_matches("fci"));
            let facts = FrankaLink::facts_of(&address).unwrap();
            let link = FrankaLink::connect(&address, facts, &study).unwrap();
            driven(link, (&study, control), samples);
            child.kill().unwrap();
            child.wait().unwrap();
        }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match &arguments[..] {
        [what, _] if what == "robot" => {
            let mut host = served::listening();
            println!("{}", host.address());
            host.serve(&mut Served::of(sides().2)).unwrap();
        }
        [class, samples] if CLASSES.contains(&class.as_str()) => {
            count(class, samples.parse().unwrap());
        }
        // As a test: that all of it runs.
        _ => CLASSES.iter().for_each(|class| count(class, 50)),
    }
}
