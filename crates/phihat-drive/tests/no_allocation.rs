//! The control thread neither allocates nor frees: 72 s of a hostile world, with the world itself in the count. Wrong if a single
//! byte were asked for between the first sample and the last.
#![allow(clippy::unwrap_used, reason = "tests: a panic is the report")]

mod support;

use std::sync::atomic::AtomicBool;

use allocation_counter::measure;
use phihat_drive::{Desk, End, Facts, Link, LinkFault, Order, Plan, SimLink, Wait, cycles, ring};
use phihat_sim::{Acted, Sample};
use support::{HOSTILE, SUPERVISED, names, sides, study};

const CYCLES: usize = 72_000;

/// A link that allocates in one sample of a thousand.
struct Wasteful(SimLink, u64);

impl Link for Wasteful {
    fn facts(&self) -> &Facts {
        self.0.facts()
    }
    fn start(&mut self) -> Result<(), LinkFault> {
        self.0.start()
    }
    fn wait(&mut self, sample: &mut Sample) -> Wait {
        self.1 += 1;
        if self.1.is_multiple_of(1000) {
            sample.joints = sample.joints.clone();
        }
        self.0.wait(sample)
    }
    fn send(&mut self, tau: &[f64]) {
        self.0.send(tau);
    }
    fn acted(&self, joint: usize, inertia: f64) -> Option<Acted> {
        self.0.acted(joint, inertia)
    }
    fn finish(&mut self, tau: &[f64]) -> Result<(), LinkFault> {
        self.0.finish(tau)
    }
    fn recover(&mut self) -> Result<(), LinkFault> {
        self.0.recover()
    }
}

/// How often so many cycles allocated.
fn allocations(text: &str, cycles_wanted: usize, wasteful: bool) -> u64 {
    let duration = format!("duration_s = {:?}", cycles_wanted as f64 * 1e-3);
    let study = study(&text.replace("duration_s = 4.0", &duration));
    let (mut control, world) = sides(&study);
    let link = SimLink::lock_step(&study, world);
    let names = names(&study);
    let order = Order::new(&names, link.facts().joints.as_deref(), names.len()).unwrap();
    let mut desk = Desk::new(order, names.len());
    let (mut tape, _reader) = ring(names.len(), cycles_wanted, false);
    let stop = AtomicBool::new(false);
    let plan =
        Plan { samples: cycles_wanted as u64, stop_samples: 0, stop: &stop, fault_samples: None };
    let mut tally = None;
    let mut wasted = Wasteful(link, 0);
    let used = measure(|| {
        tally = Some(if wasteful {
            cycles(&mut wasted, &mut control, &mut tape, &mut desk, &plan)
        } else {
            cycles(&mut wasted.0, &mut control, &mut tape, &mut desk, &plan)
        });
    });
    let tally = tally.unwrap();
    assert_eq!((tally.end, tally.cycles), (End::Complete, cycles_wanted as u64));
    assert!(tally.lost > 0, "the world is hostile");
    used.count_total
}

#[test]
fn seventy_two_thousand_cycles_allocate_nothing() {
    assert_eq!(allocations(HOSTILE, CYCLES, false), 0);
    assert_eq!(allocations(&format!("{HOSTILE}{SUPERVISED}"), CYCLES, false), 0);
    let ruled = format!(
        "{HOSTILE}[profile]\nname = \"ideal\"\nadds_gravity = true\ntorque_rate_max_nm_s = 5000.0\n"
    );
    assert_eq!(allocations(&ruled, CYCLES / 8, false), 0);
}

#[test]
fn a_link_that_allocates_is_found() {
    assert_eq!(allocations(HOSTILE, 5000, true), 5);
}
