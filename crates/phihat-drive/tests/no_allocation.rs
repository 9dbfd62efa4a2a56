//! The control thread neither allocates nor frees: 72 s of a hostile world, with the world itself in the
//! count. Wrong if a single byte were allocated between the first sample and the last.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::support::{HOSTILE, PLAIN, SUPERVISED, names, sides, study};
use allocation_counter::measure;
use phihat::Released;
use phihat_drive::{
    Desk, End, Facts, Link, LinkFault, Order, Plan, SimLink, Targets, Wait, cycles, ring,
};
use phihat_sim::{Acted, Sample};

const CYCLES: usize = 72_000;

/// A link that does something more before each sample, told its number from 1.
struct With<F>(SimLink, u64, F);

impl<F: FnMut(u64, &mut Sample)> Link for With<F> {
    fn facts(&self) -> &Facts {
        self.0.facts()
    }
    fn start(&mut self) -> Result<(), LinkFault> {
        self.0.start()
    }
    fn wait(&mut self, sample: &mut Sample) -> Wait {
        self.1 += 1;
        (self.2)(self.1, sample);
        self.0.wait(sample)
    }
    fn send(&mut self, tau: Released<'_, f64>) {
        self.0.send(tau);
    }
    fn acted(&self, joint: usize, inertia: f64) -> Option<Acted> {
        self.0.acted(joint, inertia)
    }
    fn finish(&mut self, tau: Released<'_, f64>) -> Result<(), LinkFault> {
        self.0.finish(tau)
    }
    fn recover(&mut self) -> Result<(), LinkFault> {
        self.0.recover()
    }
}

/// Number of allocations in `cycles_wanted` cycles.
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
    let plan = Plan {
        samples: cycles_wanted as u64,
        stop_samples: 0,
        stop: &stop,
        fault_samples: None,
        targets: None,
        park: None,
    };
    let mut tally = None;
    // One sample of a thousand allocates.
    let mut link = With(link, 0, |number: u64, sample: &mut Sample| {
        if wasteful && number.is_multiple_of(1000) {
            sample.joints = sample.joints.clone();
        }
    });
    let used = measure(|| {
        tally = Some(cycles(&mut link, &mut control, &mut tape, &mut desk, &plan));
    });
    let tally = tally.unwrap();
    assert_eq!((tally.end, tally.cycles), (End::Complete, cycles_wanted as u64));
    assert!(tally.lost > 0, "the world is hostile");
    used.count_total
}

/// Somebody tells the arm where to go, all the time: it goes there, and not where the study's motion is.
#[test]
fn an_arm_that_is_led_allocates_nothing() {
    let shaped = "reference_velocity_max_rad_s = 1.0\nreference_acceleration_max_rad_s2 = \
        5.0\nreference_jerk_max_rad_s3 = 50.0\n";
    let study = study(
        &format!("{PLAIN}{SUPERVISED}{shaped}").replace("duration_s = 2.0", "duration_s = 8.0"),
    );
    let (mut control, world) = sides(&study);
    let link = SimLink::lock_step(&study, world);
    let names = names(&study);
    let order = Order::new(&names, link.facts().joints.as_deref(), names.len()).unwrap();
    let mut desk = Desk::new(order, names.len());
    let (mut tape, _reader) = ring(names.len(), 8000, false);
    let (targets, stop, over) = (Targets::new(3), AtomicBool::new(false), AtomicBool::new(false));
    // The arm is on its way to the goal before the goal is requested again and again: the requesting thread
    // may be stopped half-way for as long as the whole drive takes, and then nothing newer can be read.
    let begun = AtomicBool::new(false);
    let mut link = With(link, 0, |number: u64, _: &mut Sample| {
        begun.fetch_or(number == 1000, Ordering::Relaxed);
    });
    let (samples, fault_samples) = (8000, None);
    let plan = Plan {
        samples,
        stop_samples: 0,
        stop: &stop,
        fault_samples,
        targets: Some(&targets),
        park: None,
    };
    let goal = [0.6, 1.0, 0.7];
    assert!(!targets.ask(&[0.0; 2]) && targets.ask(&goal));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                assert!(!begun.load(Ordering::Relaxed) || targets.ask(&goal));
                std::thread::yield_now();
            }
        });
        let mut tally = None;
        let used = measure(|| {
            tally = Some(cycles(&mut link, &mut control, &mut tape, &mut desk, &plan));
        });
        over.store(true, Ordering::Relaxed);
        assert_eq!((used.count_total, tally.unwrap().end), (0, End::Complete));
    });
    for (reference, goal) in control.references().iter().zip(goal) {
        assert!((reference.q - goal).abs() < 1e-3 && reference.dq.abs() < 1e-3, "{reference:?}");
    }
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
