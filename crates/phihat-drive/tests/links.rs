//! The loop on links of every kind. Wrong if joints in another order got the torques of each other, if a
//! requested stop were anything but that of the supervisor, if a robot were left moving at the end, or if the
//! record derived for a robot that reports no truth differed from the true motion of the simulated one.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::support::{HOSTILE, PLAIN, SUPERVISED, names, sides, study};
use phihat::{Gate, JointMap, Limits, Mode, Outlet, Released};
use phihat_drive::{
    Adds, Arrival, Clock, Cycle, Desk, End, Evidence, Facts, Link, LinkFault, Order, OrderError,
    Plan, SimLink, Stops, Tally, Tells, Wait, cycles, ring,
};
use phihat_sim::{Acted, Row, Sample, Trace, TraceWriter};
use phihat_study::Study;

/// The simulated arm as a robot: its joints in another order, only measurements reported, and a fault on request.
struct Robot<'a> {
    sim: SimLink,
    facts: Facts,
    /// Index of each joint of the message in the simulation.
    places: Vec<usize>,
    raw: Sample,
    tau: Vec<f64>,
    waited: u64,
    fault_at: Option<u64>,
    stop_at: Option<(u64, &'a AtomicBool)>,
    finished: u32,
    recovered: bool,
}

impl Robot<'_> {
    fn new(study: &Study, sim: SimLink, tells: Tells) -> Self {
        let n = names(study).len();
        let places: Vec<usize> = (0..n).rev().collect();
        let joints = places.iter().map(|at| names(study)[*at].clone()).collect();
        let facts = Facts {
            name: "a robot".to_owned(),
            clock: Clock::Robot,
            period_ns: 1_000_000,
            width: n,
            joints: Some(joints),
            adds: Adds { gravity: false, friction: None },
            stops: Stops::default(),
            tells,
        };
        let (raw, tau) = (Sample::of(n), vec![0.0; n]);
        let (stop_at, fault_at) = (None, None);
        Self {
            sim,
            facts,
            places,
            raw,
            tau,
            waited: 0,
            fault_at,
            stop_at,
            finished: 0,
            recovered: false,
        }
    }
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
        if let Some((_, stop)) = self.stop_at.filter(|(at, _)| self.waited == *at) {
            stop.store(true, Ordering::Relaxed);
        }
        if self.fault_at == Some(self.waited) {
            return Wait::Fault(LinkFault::Stopped("reflex"));
        }
        let wait = self.sim.wait(&mut self.raw);
        (sample.sequence, sample.t_ns) = (self.raw.sequence, self.raw.t_ns);
        for (i, place) in self.places.iter().enumerate() {
            sample.joints[i] = self.raw.joints[*place];
            sample.accepted[i] = self.raw.accepted[*place];
        }
        wait
    }
    fn send(&mut self, tau: Released<'_, f64>) {
        self.sim.send(tau.placed(&self.places, &mut self.tau));
    }
    fn acted(&self, joint: usize, inertia: f64) -> Option<Acted> {
        self.facts.tells.truth.then(|| self.sim.acted(self.places[joint], inertia))?
    }
    fn finish(&mut self, _: Released<'_, f64>) -> Result<(), LinkFault> {
        self.finished += 1;
        Ok(())
    }
    fn recover(&mut self) -> Result<(), LinkFault> {
        self.recovered = true;
        Ok(())
    }
}

const TRUTH: Tells = Tells { echo: true, losses: true, truth: true };
const NONE: Tells = Tells { echo: true, losses: true, truth: false };

/// Runs `samples` samples on a link; returns the result and the record.
fn driven<L: Link>(
    study: &Study,
    link: &mut L,
    samples: u64,
    stop: &AtomicBool,
) -> (Tally, Vec<Cycle>, Trace) {
    let (mut control, _) = sides(study);
    let names = names(study);
    let facts = link.facts().clone();
    let order = Order::new(&names, facts.joints.as_deref(), facts.width).unwrap();
    let mut desk = Desk::new(order, names.len());
    let (mut tape, mut reader) = ring(names.len(), usize::try_from(samples).unwrap(), false);
    let plan =
        Plan { samples, stop_samples: 2000, stop, fault_samples: None, targets: None, park: None };
    let tally = cycles(link, &mut control, &mut tape, &mut desk, &plan);
    drop(tape);
    // Read twice: once to look at it, once as the record is made.
    let (mut cycles, mut rows) = (Vec::new(), Vec::new());
    let (mut again, second) = ring(names.len(), usize::try_from(samples).unwrap(), false);
    while let Some(cycle) = reader.next(&mut rows) {
        cycles.push(cycle);
        assert!(again.push(cycle, rows.iter().copied()));
    }
    drop(again);
    let inertia = vec![0.42, 0.18, 0.14];
    let mut evidence = Evidence::new(&names, inertia, study.control.period_ns);
    let mut file = TraceWriter::new(Vec::new());
    let mut take = |part: &Trace| {
        file.block(part).unwrap();
        Ok(())
    };
    evidence.read(second, &mut take, |_| ()).unwrap();
    let trace = Trace::read_csv(&file.finish().unwrap()[..], study).unwrap();
    (tally, cycles, trace)
}

#[test]
fn joints_in_another_order_get_their_own_torques() {
    let study = study(HOSTILE);
    let stop = AtomicBool::new(false);
    let mut plain = SimLink::lock_step(&study, sides(&study).1);
    let (_, _, expected) = driven(&study, &mut plain, 4000, &stop);
    let mut shuffled = Robot::new(&study, SimLink::lock_step(&study, sides(&study).1), TRUTH);
    let (tally, _, found) = driven(&study, &mut shuffled, 4000, &stop);
    assert_eq!((tally.end, shuffled.finished), (End::Complete, 1));
    assert!(found == expected && found.len() == 4000, "the traces differ");
}

/// Against the core's map of a number of joints that is known when it is compiled.
#[test]
fn an_order_is_the_cores_joint_map() {
    let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let (study, link) = (["b", "a", "c"], ["c", "x", "a", "b"]);
    let map = JointMap::new(&study, &link).unwrap();
    let order = Order::new(&owned(&study), Some(&owned(&link)), 4).unwrap();
    let message = [0.1, 0.2, 0.3, 0.4];
    let mut raw = Sample::of(4);
    raw.joints.iter_mut().zip(message).for_each(|(joint, q)| joint.q = q);
    let mut sample = Sample::of(3);
    order.gather(&raw, &mut sample);
    let found: Vec<f64> = sample.joints.iter().map(|joint| joint.q).collect();
    assert_eq!(found, map.gather(&message).unwrap());
    // What no joint of the study has gets no torque, whatever stood there.
    let (mut ours, mut theirs) = (vec![9.0; 4], vec![0.0; 4]);
    let mut gate = Gate::new(vec![Outlet::new(Limits::none()); 3], None);
    gate.holding(&[1.0, 2.0, 3.0]);
    order.scatter(&gate, &mut ours);
    assert!(map.scatter(&[1.0, 2.0, 3.0], &mut theirs));
    assert_eq!(ours, theirs);
    let refused = |study: &[&str], link: &[&str]| Order::new(&owned(study), Some(&owned(link)), 3);
    assert!(matches!(refused(&["a", "d"], &["a", "b"]), Err(OrderError::Missing { .. })));
    assert!(matches!(refused(&["a", "b"], &["a", "b", "b"]), Err(OrderError::Twice(_))));
    assert!(matches!(refused(&["a", "a"], &["a", "b"]), Err(OrderError::Twice(_))));
    assert!(matches!(Order::new(&owned(&["a"]), None, 7), Err(OrderError::Width { .. })));
}

#[test]
fn a_stop_that_is_asked_for_is_the_supervisors() {
    let stop = AtomicBool::new(false);
    let supervised = study(&format!("{PLAIN}{SUPERVISED}"));
    let mut link =
        Robot::new(&supervised, SimLink::lock_step(&supervised, sides(&supervised).1), TRUTH);
    link.stop_at = Some((700, &stop));
    let (tally, cycles, trace) = driven(&supervised, &mut link, 2000, &stop);
    assert_eq!((tally.end, link.finished), (End::Asked, 1));
    let modes: Vec<Mode> = cycles.iter().map(|cycle| cycle.report.unwrap().mode).collect();
    // The sample that is waited for when it is asked is answered still.
    assert_eq!((modes[699], modes[700]), (Mode::Tracking, Mode::SafeStop));
    let last = cycles.last().unwrap().report.unwrap();
    assert!(last.brake && last.mode == Mode::SafeStop, "{last:?}");
    let speed = trace.joints.iter().map(|joint| joint.dq.last().unwrap().abs()).fold(0.0, f64::max);
    assert!(speed < 0.05, "{speed} rad/s when the brakes are asked for");
    // Nobody can stop a bare law: it ends at once.
    stop.store(false, Ordering::Relaxed);
    let bare = study(PLAIN);
    let mut link = Robot::new(&bare, SimLink::lock_step(&bare, sides(&bare).1), TRUTH);
    link.stop_at = Some((700, &stop));
    let (tally, _, _) = driven(&bare, &mut link, 2000, &stop);
    assert_eq!((tally.end, tally.cycles, link.finished), (End::Asked, 700, 1));
}

#[test]
fn a_robot_is_stopped_by_the_supervisor_when_a_drive_is_over() {
    // The motion goes on beyond what is driven of it.
    let level = "[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\nfriction = \"robot\"\n";
    let study = study(&format!("{PLAIN}{SUPERVISED}{level}"));
    let stop = AtomicBool::new(false);
    let mut link = Robot::new(&study, SimLink::lock_step(&study, sides(&study).1), NONE);
    let (tally, cycles, trace) = driven(&study, &mut link, 1000, &stop);
    assert_eq!((tally.end, tally.cycles, cycles.len()), (End::Complete, 1000, 1000));
    assert!(tally.stopping > 0 && tally.stopping < 1000, "{tally:?}");
    let speed = |link: &Robot<'_>| {
        (0..3).map(|i| link.sim.acted(i, 1.0).unwrap().dq.abs()).fold(0.0, f64::max)
    };
    let before =
        trace.joints.iter().map(|joint| joint.dq.last().unwrap().abs()).fold(0.0, f64::max);
    assert!(speed(&link) < before && link.finished == 1, "{} of {before} rad/s", speed(&link));
    let moving = cycles.last().unwrap().report.unwrap();
    assert_eq!(moving.mode, Mode::Tracking);
}

#[test]
fn a_fault_ends_the_drive_and_what_was_recorded_stays() {
    let study = study(&format!("{PLAIN}{SUPERVISED}"));
    let stop = AtomicBool::new(false);
    let mut link = Robot::new(&study, SimLink::lock_step(&study, sides(&study).1), NONE);
    link.fault_at = Some(321);
    let (tally, cycles, trace) = driven(&study, &mut link, 1000, &stop);
    assert_eq!(tally.end, End::Fault(LinkFault::Stopped("reflex")));
    // A robot that stopped by itself is not sent any last torque.
    assert_eq!((tally.cycles, cycles.len(), trace.len(), link.finished), (320, 320, 320, 0));
}

/// The torque that acted is reported with the next sample, and velocity is measured: derived values must be
/// the true ones.
#[test]
fn what_is_derived_for_a_robot_is_what_it_did() {
    let study = study(PLAIN);
    let stop = AtomicBool::new(false);
    let mut plain = SimLink::lock_step(&study, sides(&study).1);
    let (_, _, truth) = driven(&study, &mut plain, 2000, &stop);
    let mut link = Robot::new(&study, SimLink::lock_step(&study, sides(&study).1), NONE);
    let (tally, _, found) = driven(&study, &mut link, 2000, &stop);
    assert_eq!((tally.end, found.len()), (End::Complete, 2000));
    for (own, true_) in found.joints.iter().zip(&truth.joints) {
        assert_eq!(own.q, true_.q_measured);
        assert_eq!(own.tau_applied[..1999], true_.tau_applied[..1999]);
        assert_eq!(own.tau_command, true_.tau_command);
        for k in 0..1999 {
            let mean = (true_.dq[k + 1] - true_.dq[k]) / 1e-3;
            assert!((own.ddq[k] - mean).abs() < 1e-9, "{} at {k}", own.name);
            // Once the start is over, that is the acceleration itself, and φ with it.
            let (found, truth) = (own.phi[k], true_.phi[k]);
            assert!(
                k < 1000 || (found - truth).abs() < 0.02,
                "{} at {k}: {found} and {truth}",
                own.name
            );
        }
    }
}

#[test]
fn a_full_ring_is_told_and_a_patient_one_waits() {
    let row = [Row::default(); 3];
    let cycle = Cycle { t_ns: 5, arrival: Arrival::Lost, ..Cycle::default() };
    let (mut tape, mut reader) = ring(3, 2, false);
    assert!(tape.push(cycle, row.into_iter()) && tape.push(cycle, row.into_iter()));
    assert!(!tape.push(cycle, row.into_iter()));
    let mut rows = Vec::new();
    assert_eq!(reader.next(&mut rows), Some(cycle));
    assert!(rows.len() == 3 && tape.push(cycle, row.into_iter()));
    let (mut tape, mut reader) = ring(3, 2, true);
    let reading = std::thread::spawn(move || {
        let (mut rows, mut seen) = (Vec::new(), 0);
        while seen < 900 {
            seen += u32::from(reader.next(&mut rows).is_some());
        }
    });
    assert!((0..900).all(|_| tape.push(cycle, row.into_iter())));
    reading.join().unwrap();
    while tape.push(cycle, row.into_iter()) {}
    assert!(tape.is_unread(), "a patient tape waits for a reader that is there");
}
