//! An arm without brakes is parked before its torque ends. Wrong if it were parked with a fault, without a
//! position in the study, or faster than the study allows; if its torque ended before it is there and at
//! rest; or if a second request did not stop it on the way.

use std::fs;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::support::{PLAIN, SUPERVISED, folder, names, sides, study};
use phihat::{Mode, Released, Report};
use phihat_drive::{
    CheckName, Desk, DriveOptions, End, Facts, Link, LinkFault, Order, Park, Parked, Plan, SimLink,
    Tally, Wait, cycles, prepare, ring,
};
use phihat_session::{FirstMotion, Leave, RunOptions, Watch};
use phihat_sim::Sample;
use phihat_study::Study;

const PLACE: [f64; 3] = [0.3, 0.4, 0.2];

/// A planar arm that states a place to park, and how fast \[rad/s\].
fn arm() -> Study {
    slow_arm(0.5)
}

fn slow_arm(speed: f64) -> Study {
    study(&text(speed))
}

fn text(speed: f64) -> String {
    format!(
        "{PLAIN}{SUPERVISED}park_rad = {PLACE:?}\nreference_velocity_max_rad_s = {speed:?}\n\
         reference_acceleration_max_rad_s2 = 2.0\nreference_jerk_max_rad_s3 = 20.0\n"
    )
}

/// Event at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    /// A person asks for the end.
    Asked,
    /// A position is none from here on.
    Blind,
    /// The robot stops.
    Stops,
}

/// The simulated arm as a robot that goes on for as long as it is asked.
struct Robot<'a> {
    sim: SimLink,
    facts: Facts,
    stop: &'a AtomicBool,
    events: Vec<(u64, Event)>,
    waited: u64,
    blind: bool,
    /// Last measured positions, and the largest speed after the study's end or the first request.
    q: Vec<f64>,
    fastest: f64,
    ending: bool,
    report: Option<Report>,
    finished: u32,
}

impl Link for Robot<'_> {
    fn facts(&self) -> &Facts {
        &self.facts
    }
    fn start(&mut self) -> Result<(), LinkFault> {
        self.sim.start()
    }
    fn wait(&mut self, sample: &mut Sample) -> Wait {
        self.waited += 1;
        let now = self.waited;
        for (_, event) in self.events.iter().filter(|(at, _)| *at == now) {
            match event {
                Event::Asked => self.stop.store(true, Ordering::Relaxed),
                Event::Blind => self.blind = true,
                Event::Stops => return Wait::Fault(LinkFault::Stopped("reflex")),
            }
        }
        let asked = self.events.first().is_some_and(|(at, _)| *at < now);
        self.ending |= asked || now > 2000;
        let wait = self.sim.wait(sample);
        self.q = sample.joints.iter().map(|joint| joint.q).collect();
        if self.ending {
            let speeds = sample.joints.iter().map(|joint| joint.dq.abs());
            self.fastest = speeds.fold(self.fastest, f64::max);
        }
        if self.blind {
            sample.joints[1].q = f64::NAN;
        }
        wait
    }
    fn supervised(&mut self, report: Option<&Report>) {
        self.report = report.copied();
    }
    fn send(&mut self, tau: Released<'_, f64>) {
        self.sim.send(tau);
    }
    fn finish(&mut self, _: Released<'_, f64>) -> Result<(), LinkFault> {
        self.finished += 1;
        Ok(())
    }
    fn recover(&mut self) -> Result<(), LinkFault> {
        Err(LinkFault::NoRecovery)
    }
}

/// Result of a drive of two seconds.
struct Came {
    tally: Tally,
    /// Largest distance from the place \[rad\], and the largest speed on the way \[rad/s\].
    away: f64,
    fastest: f64,
    report: Report,
    finished: u32,
    /// True if a stop request is left that was not taken.
    asked: bool,
}

fn driven(study: &Study, limits: Option<&[Vec<f64>; 3]>, events: &[(u64, Event)]) -> Came {
    let mut ready = study.clone();
    ready.duration = 30.0;
    let (mut control, world) = sides(&ready);
    let sim = SimLink::lock_step(&ready, world);
    let mut facts = sim.facts().clone();
    facts.tells.truth = false;
    let stop = AtomicBool::new(false);
    let mut link = Robot {
        sim,
        facts,
        stop: &stop,
        events: events.to_vec(),
        waited: 0,
        blind: false,
        q: Vec::new(),
        fastest: 0.0,
        ending: false,
        report: None,
        finished: 0,
    };
    let names = names(study);
    let mut desk = Desk::new(Order::new(&names, None, 3).unwrap(), 3);
    let (mut tape, _reader) = ring(3, 2000, false);
    let supervisor = study.supervisor.as_deref().unwrap();
    let limits = limits.or(supervisor.motion.as_ref());
    let park = supervisor.park.as_deref().map(|q| Park { q, limits: limits.unwrap() });
    let plan = Plan {
        samples: 2000,
        stop_samples: 5000,
        stop: &stop,
        fault_samples: None,
        targets: None,
        park,
    };
    let tally = cycles(&mut link, &mut control, &mut tape, &mut desk, &plan);
    let away = link.q.iter().zip(PLACE).map(|(q, place)| (q - place).abs()).fold(0.0, f64::max);
    let (fastest, report, finished) = (link.fastest, link.report.unwrap(), link.finished);
    Came { tally, away, fastest, report, finished, asked: stop.load(Ordering::Relaxed) }
}

fn parked(tally: &Tally) -> (bool, u64) {
    let Some(Parked { samples, reached }) = tally.parked else { return (false, 0) };
    (reached, samples)
}

/// At the end of the motion, and after a stop request: the arm is at its position, at rest, within the
/// limits, and the torque ends last.
#[test]
fn a_drive_that_goes_well_ends_where_the_arm_parks() {
    for (events, end) in [(vec![], End::Complete), (vec![(900, Event::Asked)], End::Asked)] {
        let came = driven(&arm(), None, &events);
        let (reached, samples) = parked(&came.tally);
        assert!(reached && came.tally.end == end && came.finished == 1, "{:?}", came.tally);
        assert!(came.away < 0.01, "{} rad away", came.away);
        // The farthest joint has some 0.7 rad to go at 0.5 rad/s.
        assert!(
            (1000..4000).contains(&samples) && came.fastest < 0.7,
            "{samples} {}",
            came.fastest
        );
        assert!(came.fastest > 0.3, "{} rad/s", came.fastest);
        assert!(came.report.mode == Mode::SafeStop && came.report.brake, "{:?}", came.report);
        assert!(came.report.fault.is_none() && !came.asked);
    }
}

/// A second request stops the arm where it is, and is not taken back.
#[test]
fn a_second_request_stops_the_arm_on_the_way() {
    for first in [(900, Event::Asked), (2300, Event::Asked)] {
        let second = if first.0 < 2000 { vec![first, (1300, Event::Asked)] } else { vec![first] };
        let came = driven(&arm(), None, &second);
        let (reached, samples) = parked(&came.tally);
        assert!(!reached && samples < 500 && came.asked, "{:?}", came.tally);
        assert!(came.away > 0.1 && came.finished == 1, "{} rad away", came.away);
        assert!(came.report.mode == Mode::SafeStop && came.report.brake, "{:?}", came.report);
    }
}

/// With a fault nothing moves: before the end, on the way, and where the robot itself stops.
#[test]
fn with_a_fault_nothing_is_parked() {
    let before = driven(&arm(), None, &[(1000, Event::Blind), (1500, Event::Asked)]);
    assert_eq!(before.tally.parked, None);
    assert!(before.report.fault.is_some() && before.finished == 1, "{:?}", before.report);

    let on_the_way = driven(&arm(), None, &[(900, Event::Asked), (1300, Event::Blind)]);
    let (reached, samples) = parked(&on_the_way.tally);
    assert!(!reached && (400..500).contains(&samples), "{:?}", on_the_way.tally);
    assert_eq!((on_the_way.tally.end, on_the_way.finished), (End::Faulted, 1));
    assert!(on_the_way.report.mode == Mode::SafeStop && on_the_way.report.brake);

    let stopped = driven(&arm(), None, &[(900, Event::Asked), (1300, Event::Stops)]);
    assert!(!parked(&stopped.tally).0 && stopped.finished == 0);
    assert_eq!(stopped.tally.end, End::Fault(LinkFault::Stopped("reflex")));
}

/// A way that takes longer than its limits say is given up, and the arm stopped.
#[test]
fn a_way_without_an_end_is_given_up() {
    let fast = [50.0, 2000.0, 2e5].map(|limit| vec![limit; 3]);
    let came = driven(&slow_arm(0.1), Some(&fast), &[]);
    let (reached, samples) = parked(&came.tally);
    // Two seconds, and twice what it would take.
    assert!(!reached && (2200..2300).contains(&samples), "{:?}", came.tally);
    assert!(came.report.mode == Mode::SafeStop && came.finished == 1);
}

/// Nothing moves after the end where the study states no place, and before the arm tracks.
#[test]
fn without_a_place_or_before_the_motion_nothing_is_parked() {
    let mut nowhere = arm();
    nowhere.supervisor.as_mut().unwrap().park = None;
    let came = driven(&nowhere, None, &[]);
    assert!(came.tally.parked.is_none() && came.away > 0.1 && came.finished == 1);
    let early = driven(&arm(), None, &[(1, Event::Asked)]);
    assert!(early.tally.parked.is_none() && early.tally.end == End::Asked, "{:?}", early.tally);
}

/// A person who asks once, as soon as the drive is seen to go on.
struct Asks<'a>(&'a AtomicBool, bool);

impl Watch for Asks<'_> {
    fn progress(&mut self, done: u64, _: u64) {
        if done > 0 && !core::mem::replace(&mut self.1, true) {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

/// From the study's file to the record.
#[test]
fn a_drive_of_a_study_is_parked_and_says_so() {
    let folder = folder("parking");
    let path = folder.join("arm.toml");
    fs::write(&path, text(0.5).replace("duration_s = 2.0", "duration_s = 60.0")).unwrap();
    let run = RunOptions {
        study: path,
        out: Some(folder.join("out")),
        uncertified: true,
        ..RunOptions::default()
    };
    let options = DriveOptions { run, accept: CheckName::ALL.to_vec(), ..DriveOptions::default() };
    let prepared = prepare(&options).unwrap();
    assert!(prepared.parks());
    let stop = AtomicBool::new(false);
    let leave = Leave { folder: &folder.join("out"), page: None };
    let driven = prepared.drive(leave, &mut Asks(&stop, false), &stop).unwrap();
    assert_eq!(driven.document["end"], "asked");
    assert_eq!(driven.document["parked"]["reached"], true, "{:#}", driven.document);
    let line = driven.facts.iter().find(|(label, _)| label == "parked");
    assert!(line.is_some_and(|(_, words)| words.starts_with("there after ")), "{line:?}");

    // Not under gains that nobody designed.
    let first = DriveOptions { first: Some(FirstMotion::default()), ..options };
    assert!(!prepare(&first).unwrap().parks());
}
