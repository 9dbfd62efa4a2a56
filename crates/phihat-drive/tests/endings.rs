//! However the rest of a drive's process ends, its arm is brought to rest. Wrong if a panic, or a record that
//! cannot be written, left the last torque on.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use crate::support::{PLAIN, SUPERVISED, folder, sides};
use phihat::{Mode, Released, Report};
use phihat_drive::{
    CheckName, Cycle, DriveError, DriveOptions, Facts, Link, LinkFault, SimLink, Tap, Wait,
    prepare_on,
};
use phihat_session::{Leave, RunOptions};
use phihat_sim::{Row, Sample};
use phihat_study::Study;

/// Record of a robot about one drive.
#[derive(Debug, Default, Clone, Copy)]
struct Seen {
    stops: u64,
    brake: bool,
    finished: u32,
}

struct Robot {
    sim: SimLink,
    facts: Facts,
    seen: Arc<Mutex<Seen>>,
}

impl Link for Robot {
    fn facts(&self) -> &Facts {
        &self.facts
    }
    fn start(&mut self) -> Result<(), LinkFault> {
        self.sim.start()
    }
    fn wait(&mut self, sample: &mut Sample) -> Wait {
        self.sim.wait(sample)
    }
    fn supervised(&mut self, report: Option<&Report>) {
        let mut seen = self.seen.lock().unwrap();
        if let Some(report) = report.filter(|report| report.mode == Mode::SafeStop) {
            seen.stops += 1;
            seen.brake |= report.brake;
        }
    }
    fn send(&mut self, tau: Released<'_, f64>) {
        self.sim.send(tau);
    }
    fn finish(&mut self, _: Released<'_, f64>) -> Result<(), LinkFault> {
        self.seen.lock().unwrap().finished += 1;
        Ok(())
    }
    fn recover(&mut self) -> Result<(), LinkFault> {
        Err(LinkFault::NoRecovery)
    }
}

/// Panics, as a program may that looks on.
struct Panics(u32);

impl Tap for Panics {
    fn sample(&mut self, _: &Cycle, _: &[Row]) {
        self.0 -= 1;
        assert!(self.0 > 0, "a mistake somewhere else in the process");
    }
}

/// A drive of two seconds, whose folder or onlooker may be bad.
fn driven(name: &str, tap: Option<Panics>, spoil: bool) -> (Option<Result<(), DriveError>>, Seen) {
    let folder = folder(name);
    let path = folder.join("arm.toml");
    // More samples than the ring between the threads holds.
    let text = format!("{PLAIN}{SUPERVISED}").replace("duration_s = 2.0", "duration_s = 20.0");
    fs::write(&path, text).unwrap();
    let study = Study::read(&path).unwrap();
    let seen = Arc::new(Mutex::new(Seen::default()));
    // The arm is there for longer than it is driven.
    let mut study_ready = study.clone();
    study_ready.duration = 30.0;
    phihat_sim::derive_substeps(&mut study_ready);
    let sim = SimLink::lock_step(&study_ready, sides(&study_ready).1);
    let mut facts = sim.facts().clone();
    facts.tells.truth = false;
    let link = Robot { sim, facts, seen: seen.clone() };
    let out = folder.join("out");
    let run = RunOptions {
        study: path,
        out: Some(out.clone()),
        uncertified: true,
        ..RunOptions::default()
    };
    let accept = CheckName::ALL.to_vec();
    let options = DriveOptions { run, accept, ..DriveOptions::default() };
    let mut prepared = prepare_on(&options, Box::new(link)).unwrap();
    if let Some(tap) = tap {
        prepared.shown_to(Box::new(tap));
    }
    if spoil {
        // A file stands where the record's folder should be.
        fs::write(&out, "in the way").unwrap();
    }
    let leave = Leave { folder: &out, page: None };
    let stop = AtomicBool::new(false);
    let result =
        catch_unwind(AssertUnwindSafe(|| prepared.drive(leave, &mut (), &stop).map(drop))).ok();
    let seen = *seen.lock().unwrap();
    (result, seen)
}

#[test]
fn a_panic_elsewhere_in_the_process_stops_the_arm() {
    let (result, seen) = driven("ending-panic", Some(Panics(300)), false);
    assert!(result.is_none(), "the panic goes on");
    assert!(seen.brake && seen.stops > 0 && seen.finished == 1, "{seen:?}");
}

/// Nothing moves where the record has no place to begin with.
#[test]
fn a_record_without_a_place_is_told_before_anything_moves() {
    let (result, seen) = driven("ending-disk", None, true);
    assert!(matches!(result, Some(Err(_))), "{result:?}");
    assert!(seen.finished == 0 || seen.brake, "{seen:?}");
}

#[test]
fn a_drive_that_ends_well_is_brought_to_rest_too() {
    let (result, seen) = driven("ending-well", None, false);
    assert!(matches!(result, Some(Ok(()))), "{result:?}");
    assert!(seen.brake && seen.finished == 1, "{seen:?}");
}
