//! Cycles over the Franka Control Interface, many of them: `PHIHAT_CYCLES=3600000` for an hour. Wrong if the
//! control thread allocated in a cycle, if memory grew, or if the error did. A program of its own: memory is
//! counted per process, and other tests would add to it.
#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

#[path = "../support/mod.rs"]
mod support;

use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Duration;

use crate::support::served::{self, DRIVEN, Served};
use crate::support::{PANDA, names, study};
use allocation_counter::measure;
use phihat_design::requested_gains;
use phihat_drive::{
    Desk, End, FrankaAddress, FrankaLink, Link as _, Order, Plan, Reader, cycles, ring,
};
use phihat_fci::{Ending, Protocol};
use phihat_sim::Simulation;

/// Largest |e| \[rad\] in the second tenth of the cycles and in the last.
fn errors(mut reader: Reader, count: u64) -> [f64; 2] {
    let (mut rows, mut seen, mut found) = (Vec::new(), 0, [0.0_f64; 2]);
    loop {
        let ended = reader.is_ended();
        while reader.next(&mut rows).is_some() {
            let tenth = seen * 10 / count;
            let most = rows.iter().map(|row| (row.measurement.q - row.reference.q).abs());
            let most = most.fold(0.0, f64::max);
            match tenth {
                1 => found[0] = found[0].max(most),
                9 => found[1] = found[1].max(most),
                _ => {}
            }
            seen += 1;
        }
        if ended {
            return found;
        }
        thread::sleep(Duration::from_millis(1));
    }
}

/// Memory of this process \[kB\].
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|line| line.trim().split(' ').next()?.parse().ok()).unwrap_or_default()
}

/// Drives so many cycles; allocations of the control thread, errors, and by how much memory grew \[kB\].
fn driven(count: u64, protocol: Protocol) -> (u64, [f64; 2], u64) {
    let study = study(&format!("duration_s = 3900.0\nseed = 5\n{PANDA}{DRIVEN}"));
    let gains = requested_gains(&study).unwrap();
    let names = names(&study);
    let law = gains.joint_gains(&names, study.control.period_ns, study.control.form).unwrap();
    let (mut control, side) = Simulation::new(&study, &law).unwrap().apart();
    let mut host = served::listening();
    let (at, patience) = (host.address().to_string(), Duration::from_mins(1));
    let address = FrankaAddress { host: at, protocol: Some(protocol), patience };
    let mut world = Served::of(side);
    let serving = thread::spawn(move || {
        host.serve(&mut world).unwrap();
        world.ended
    });
    let facts = FrankaLink::facts_of(&address).unwrap();
    let mut link = FrankaLink::connect(&address, facts, &study).unwrap();
    let mut desk = Desk::new(Order::new(&names, None, 7).unwrap(), 7);
    let (mut tape, reader) = ring(7, 1024, true);
    let stop = AtomicBool::new(false);
    let plan = Plan {
        samples: count,
        stop_samples: 5000,
        stop: &stop,
        fault_samples: None,
        targets: None,
        park: None,
    };
    let reading = thread::spawn(move || errors(reader, count));
    let before = resident();
    link.start().unwrap();
    let mut tally = None;
    let used = measure(|| {
        tally = Some(cycles(&mut link, &mut control, &mut tape, &mut desk, &plan));
    });
    drop(tape);
    let tally = tally.unwrap();
    assert_eq!((tally.end, tally.cycles, tally.finished), (End::Complete, count, Ok(())));
    assert!(tally.lost > count / 200 && tally.lost < count / 50, "{tally:?}");
    let grown = resident().saturating_sub(before);
    drop(link);
    assert_eq!(serving.join().unwrap(), Some(Ending::Finished));
    (used.count_total, reading.join().unwrap(), grown)
}

#[test]
fn cycles_allocate_nothing_and_neither_memory_nor_the_error_grows() {
    let asked = std::env::var("PHIHAT_CYCLES").ok().and_then(|count| count.parse().ok());
    let count = asked.unwrap_or(20_000);
    for protocol in Protocol::ALL {
        let (allocations, [early, late], grown) = driven(count, protocol);
        println!(
            "{count} cycles, version {}: {allocations} allocations, |e| {early:.2e} and {late:.2e} rad, {grown} kB",
            protocol.version()
        );
        assert_eq!(allocations, 0);
        assert!(late < 1.5 * early + 1e-5, "{early} {late}");
        assert!(grown < 4096, "{grown} kB");
    }
}
