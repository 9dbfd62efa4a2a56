//! The loop of the control thread: wait, bind, control, send, record.

use std::sync::atomic::{AtomicBool, Ordering};

use phihat::{Mode, Report};
use phihat_sim::{ControlSide, Row, Sample};

use crate::hooks::Targets;
use crate::link::{Link, LinkFault, Wait};
use crate::order::Order;
use crate::tape::{Arrival, Cycle, Tape};

/// Why a loop ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// Every sample of the study is done.
    Complete,
    /// A person asked for it, and the arm is stopped.
    Asked,
    /// There was nothing more to come before the study's end: a simulated arm diverged.
    Over,
    /// The link does not go on.
    Fault(LinkFault),
    /// The supervisor found a fault, and had its time to stop the arm.
    Faulted,
    /// Whoever writes the record does not keep up, or gave up.
    Unread,
}

impl End {
    /// One word for files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Asked => "asked",
            Self::Over => "over",
            Self::Fault(_) => "fault",
            Self::Faulted => "faulted",
            Self::Unread => "unread",
        }
    }
}

/// What a loop is told.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// Samples of the study.
    pub samples: u64,
    /// Samples that a stop may take after the last one.
    pub stop_samples: u64,
    /// Set by whoever wants the arm to stop.
    pub stop: &'a AtomicBool,
    /// Samples for which a supervisor that found a fault may go on to stop the arm; `None`: to the end. A drive that is wired the wrong
    /// way round is pushed away by what should stop it.
    pub fault_samples: Option<u64>,
    /// Where others ask the arm to go, if they may.
    pub targets: Option<&'a Targets>,
}

/// What came of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tally {
    /// Why it ended.
    pub end: End,
    /// Samples that were answered and recorded.
    pub cycles: u64,
    /// Samples among them that did not come.
    pub lost: u64,
    /// Samples among them in which the arm followed its motion: an arm that may not is held.
    pub tracked: u64,
    /// Samples after the study's end, until the supervisor asked for the brakes.
    pub stopping: u64,
    /// What the link said of the end.
    pub finished: Result<(), LinkFault>,
}

/// Room for the samples and torques of a loop: allocated once.
#[derive(Debug)]
pub struct Desk {
    order: Order,
    raw: Sample,
    sample: Sample,
    out: Vec<f64>,
    /// What others asked for last, and which of their targets it is.
    target: (u64, Vec<f64>),
}

impl Desk {
    /// For a link whose joints stand in this order.
    pub fn new(order: Order, joints: usize) -> Self {
        let width = order.width();
        Self {
            raw: Sample::of(width),
            sample: Sample::of(joints),
            out: vec![0.0; width],
            target: (0, vec![0.0; joints]),
            order,
        }
    }

    /// One sample: what came is answered and sent.
    fn cycle<L: Link>(&mut self, link: &mut L, control: &mut ControlSide) -> Result<Cycle, End> {
        let (t_ns, arrival) = match link.wait(&mut self.raw) {
            Wait::Fresh { t_ns } => (t_ns, Arrival::Fresh),
            Wait::Lost { t_ns } => (t_ns, Arrival::Lost),
            Wait::Skipped { t_ns } => (t_ns, Arrival::Skipped),
            Wait::Fault(why) => return Err(End::Fault(why)),
            Wait::Over => return Err(End::Over),
        };
        let late_ns = link.late_ns();
        let begun = link.now_ns();
        self.order.gather(&self.raw, &mut self.sample);
        control.step(t_ns as f64 * 1e-9, &self.sample, arrival != Arrival::Skipped);
        let took_ns = link.now_ns().zip(begun).map(|(now, begun)| now.saturating_sub(begun));
        let report = control.report().copied();
        link.supervised(report.as_ref());
        link.send(self.order.scatter(control.gate(), &mut self.out));
        let known = link.facts().tells.truth;
        Ok(Cycle { t_ns, arrival, report, known, late_ns, took_ns })
    }

    /// The joints' part of the sample that was answered last.
    fn rows<L: Link>(&self, link: &L, control: &ControlSide) -> impl Iterator<Item = Row> {
        let told = control.references().iter().zip(control.commands());
        let joints = self.sample.joints.iter().zip(told).enumerate();
        joints.map(move |(i, (measurement, (reference, command)))| Row {
            measurement: *measurement,
            reference: *reference,
            command: *command,
            acted: link.acted(self.order.place(i), control.inertia(i)).unwrap_or_default(),
        })
    }
}

/// By how much a robot's time is ahead of this machine's \[ns\] where the robot waits for its client: no real one ever is.
const AHEAD_NS: u64 = 1_000_000_000;

/// Runs the loop to its end. Nothing is allocated or locked here, and the system is not called but by the link.
///
/// A stop that is asked for is the supervisor's safe stop, until it asks for the brakes; without a supervisor the loop ends at once.
/// At the study's end an arm that is not simulated is stopped in the same way.
pub fn cycles<L: Link>(
    link: &mut L,
    control: &mut ControlSide,
    tape: &mut Tape,
    desk: &mut Desk,
    plan: &Plan<'_>,
) -> Tally {
    let mut tally =
        Tally { end: End::Complete, cycles: 0, lost: 0, tracked: 0, stopping: 0, finished: Ok(()) };
    let (mut stopping, mut faulted) = (false, None);
    let (begun, period_ns) = (link.now_ns(), link.facts().period_ns);
    while tally.cycles < plan.samples {
        // The first sample is answered: a record has one at least.
        if !stopping && tally.cycles > 0 && plan.stop.load(Ordering::Relaxed) {
            stopping = control.stop();
            if !stopping {
                tally.end = End::Asked;
                break;
            }
        }
        let (seen, q) = &mut desk.target;
        // Tracking begins where the arm stands; from there on it can be led.
        let led = plan.targets.filter(|_| tally.tracked > 0);
        if led.is_some_and(|targets| targets.newer(seen, q)) {
            control.refer_to(q);
        }
        let cycle = match desk.cycle(link, control) {
            Ok(cycle) => cycle,
            Err(end) => {
                tally.end = end;
                break;
            }
        };
        tally.cycles += 1;
        tally.lost += u64::from(cycle.arrival == Arrival::Lost);
        let tracks = cycle.report.is_none_or(|report| report.mode == Mode::Tracking);
        tally.tracked += u64::from(tracks);
        let passed = link.now_ns().zip(begun).map(|(now, begun)| now.saturating_sub(begun));
        tape.ahead(passed.is_some_and(|ns| tally.cycles * period_ns > ns + AHEAD_NS));
        if !tape.push(cycle, desk.rows(link, control)) {
            tally.end = End::Unread;
            break;
        }
        if stopping && is_stopped(cycle.report.as_ref()) {
            tally.end = End::Asked;
            break;
        }
        let fault = cycle.report.filter(|report| report.fault.is_some());
        faulted = fault.map(|_| faulted.unwrap_or(tally.cycles));
        if let (Some(most), Some(fault), Some(since)) = (plan.fault_samples, fault, faulted)
            && (fault.brake || tally.cycles - since >= most)
        {
            tally.end = End::Faulted;
            break;
        }
    }
    if tally.end == End::Complete && faulted.is_some() && !link.facts().tells.truth {
        tally.end = End::Faulted;
    }
    if matches!(tally.end, End::Complete | End::Unread) && !link.facts().tells.truth {
        come_to_rest(link, control, desk, plan, &mut tally);
    }
    if !matches!(tally.end, End::Fault(_) | End::Over) {
        tally.finished = link.finish(desk.order.scatter(control.gate(), &mut desk.out));
    }
    tally
}

/// A safe stop after the last sample, which is not recorded.
fn come_to_rest<L: Link>(
    link: &mut L,
    control: &mut ControlSide,
    desk: &mut Desk,
    plan: &Plan<'_>,
    tally: &mut Tally,
) {
    if !control.stop() {
        return;
    }
    while tally.stopping < plan.stop_samples {
        tally.stopping += 1;
        match desk.cycle(link, control) {
            Ok(cycle) if is_stopped(cycle.report.as_ref()) => return,
            Ok(_) => {}
            Err(End::Fault(why)) => {
                tally.end = End::Fault(why);
                return;
            }
            Err(_) => return,
        }
    }
}

/// Whether an arm that was told to stop stands, or has no torque.
fn is_stopped(report: Option<&Report>) -> bool {
    report.is_none_or(|report| report.brake || report.mode == Mode::Idle)
}
