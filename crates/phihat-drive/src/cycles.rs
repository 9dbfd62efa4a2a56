//! The loop of the control thread: wait, bind, control, send, record.

use std::sync::atomic::{AtomicBool, Ordering};

use phihat::{Mode, Reference, Report, VelocityFilter, VelocityState};
use phihat_sim::{ControlSide, Row, Sample};
use serde::Serialize;

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

/// Plan of a loop: samples, stop request, targets and parking.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// Samples of the study.
    pub samples: u64,
    /// Samples that a stop may take after the last one.
    pub stop_samples: u64,
    /// Set by whoever wants the arm to stop.
    pub stop: &'a AtomicBool,
    /// Samples for which a supervisor that found a fault may go on to stop the arm; `None`: to the end. If a
    /// drive is wired with the wrong sign, the torque that should stop the arm pushes it away.
    pub fault_samples: Option<u64>,
    /// Positions that others request; `None`: none are accepted.
    pub targets: Option<&'a Targets>,
    /// Parking position, to which the arm moves before its torque ends; `None`: it is not parked.
    pub park: Option<Park<'a>>,
}

/// Parking position of an arm without brakes, at the end of a drive without a fault. One entry per joint, in
/// the study's order.
#[derive(Debug, Clone, Copy)]
pub struct Park<'a> {
    /// Positions \[rad, m\].
    pub q: &'a [f64],
    /// Limits of velocity, acceleration and jerk on the way.
    pub limits: &'a [Vec<f64>; 3],
}

/// Result of parking.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Parked {
    /// Samples on the way.
    pub samples: u64,
    /// True if the reference came to rest there; else the arm was stopped on the way.
    pub reached: bool,
}

impl Parked {
    /// Warning if the position was not reached.
    pub(crate) fn doubt(self) -> Option<String> {
        (!self.reached).then(|| "stopped on the way to where it parks".to_owned())
    }

    /// A line about it: label and value.
    pub(crate) fn words(self, period_ns: u64) -> (String, String) {
        let seconds = (self.samples * period_ns) as f64 * 1e-9;
        let words = if self.reached { "there" } else { "stopped on the way" };
        ("parked".to_owned(), format!("{words} after {seconds:.3} s"))
    }
}

/// Result of a loop.
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
    /// Result of parking; `None`: it did not begin (no position in the study, or a fault).
    pub parked: Option<Parked>,
    /// Result of [`Link::finish`]; `Ok` where it was not called.
    pub finished: Result<(), LinkFault>,
}

/// Room for the samples and torques of a loop: allocated once.
#[derive(Debug)]
pub struct Desk {
    order: Order,
    raw: Sample,
    sample: Sample,
    out: Vec<f64>,
    /// Version and positions of the last target that others requested.
    target: (u64, Vec<f64>),
    velocity: Option<DeskVelocity>,
}

/// Velocities of a loop from its positions.
#[derive(Debug)]
struct DeskVelocity {
    filter: VelocityFilter<f64>,
    /// One per joint, in the study's order.
    states: Vec<VelocityState<f64>>,
    /// Time of the last sample that came \[ns\].
    last_ns: u64,
}

impl DeskVelocity {
    /// Puts velocities in place of those of a sample at this time \[ns\]: of one that came, a new estimate; of one that
    /// did not, the last one.
    fn estimate(&mut self, t_ns: u64, arrival: Arrival, sample: &mut Sample) {
        let fresh = arrival == Arrival::Fresh;
        let interval = t_ns.saturating_sub(self.last_ns) as f64 * 1e-9;
        for (joint, state) in sample.joints.iter_mut().zip(&mut self.states) {
            let mut next = *state;
            // Over no time the estimate stays.
            joint.dq = self.filter.estimate(&mut next, joint.q, if fresh { interval } else { 0.0 });
            if fresh {
                *state = next;
            }
        }
        if fresh {
            self.last_ns = t_ns;
        }
    }
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
            velocity: None,
        }
    }

    /// The same, with velocities that are differences of the positions behind a filter, in place of the link's: the
    /// velocity that gains are certified for, where a study says `velocity = "differenced"`.
    #[must_use]
    pub fn differencing(mut self, filter: VelocityFilter<f64>) -> Self {
        let states = vec![VelocityState::default(); self.sample.joints.len()];
        self.velocity = Some(DeskVelocity { filter, states, last_ns: 0 });
        self
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
        if let Some(velocity) = &mut self.velocity {
            velocity.estimate(t_ns, arrival, &mut self.sample);
        }
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

/// Lead of a robot's time over this machine's \[ns\] above which the robot waits for its client: no real
/// robot does.
const AHEAD_NS: u64 = 1_000_000_000;

/// Runs the loop to its end. Nothing is allocated or locked here, and only the link makes system calls.
///
/// A requested stop is the supervisor's safe stop, until it requests the brakes; without a supervisor the
/// loop ends at once. At the study's end an arm that is not simulated is stopped in the same way. If the plan
/// has a parking position and the arm tracks without a fault, the arm goes there first; that clears the
/// request, so the next one stops it on the way.
pub fn cycles<L: Link>(
    link: &mut L,
    control: &mut ControlSide,
    tape: &mut Tape,
    desk: &mut Desk,
    plan: &Plan<'_>,
) -> Tally {
    let mut tally = Tally {
        end: End::Complete,
        cycles: 0,
        lost: 0,
        tracked: 0,
        stopping: 0,
        parked: None,
        finished: Ok(()),
    };
    let (mut stopping, mut faulted) = (false, None);
    let (begun, period_ns) = (link.now_ns(), link.facts().period_ns);
    while tally.cycles < plan.samples {
        // The first sample is answered: a record has one at least.
        if !stopping && tally.cycles > 0 && plan.stop.load(Ordering::Relaxed) {
            let parks = plan.park.is_some() && is_well(control.report());
            stopping = !parks && control.stop();
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
    come_to_an_end(link, control, desk, (plan, stopping), &mut tally);
    tally
}

/// Ends a drive after its last sample: way to the parking position, stop, and last torque.
fn come_to_an_end<L: Link>(
    link: &mut L,
    control: &mut ControlSide,
    desk: &mut Desk,
    (plan, stopping): (&Plan<'_>, bool),
    tally: &mut Tally,
) {
    let truth = link.facts().tells.truth;
    let ends = match tally.end {
        End::Asked => !stopping,
        End::Complete => !truth,
        _ => false,
    };
    if let Some(place) = plan.park.filter(|_| ends && is_well(control.report())) {
        park(link, control, desk, (plan, place), tally);
    }
    let rests = match tally.end {
        End::Complete | End::Unread => !truth,
        End::Asked | End::Faulted => tally.parked.is_some(),
        End::Fault(_) | End::Over => false,
    };
    if rests {
        come_to_rest(link, control, desk, plan, tally);
    }
    if !matches!(tally.end, End::Fault(_) | End::Over) {
        tally.finished = link.finish(desk.order.scatter(control.gate(), &mut desk.out));
    }
}

/// Longest time of the way to the parking position: this factor times the time by its limits, plus a margin \[ns\].
const PARK_TIMES: f64 = 2.0;
const PARK_NS: f64 = 2e9;

/// Largest distance \[rad, m\] and speed \[rad/s, m/s\] at which a reference counts as at its parking position.
const THERE: f64 = 1e-4;

/// Moves the arm to its parking position; this is not recorded. A fault, the next request to stop, or a way
/// that takes too long ends it where the arm is.
fn park<L: Link>(
    link: &mut L,
    control: &mut ControlSide,
    desk: &mut Desk,
    (plan, place): (&Plan<'_>, Park<'_>),
    tally: &mut Tally,
) {
    if !control.refer_to(place.q) {
        return;
    }
    // The request is taken.
    plan.stop.store(false, Ordering::Relaxed);
    let most = place.samples(control.references(), link.facts().period_ns);
    let mut parked = Parked { samples: 0, reached: false };
    while parked.samples < most && !plan.stop.load(Ordering::Relaxed) && !parked.reached {
        parked.samples += 1;
        match desk.cycle(link, control) {
            Ok(cycle) if is_well(cycle.report.as_ref()) => {
                let mut joints = control.references().iter().zip(place.q);
                parked.reached =
                    joints.all(|(at, q)| (at.q - q).abs() <= THERE && at.dq.abs() <= THERE);
            }
            Ok(cycle) => {
                let fault = cycle.report.is_some_and(|report| report.fault.is_some());
                tally.end = if fault { End::Faulted } else { tally.end };
                break;
            }
            Err(end) => {
                let fault = matches!(end, End::Fault(_));
                tally.end = if fault { end } else { tally.end };
                break;
            }
        }
    }
    tally.parked = Some(parked);
}

impl Park<'_> {
    /// The most samples that the way from these references may take.
    fn samples(&self, from: &[Reference<f64>], period_ns: u64) -> u64 {
        let [velocity, acceleration, jerk] = self.limits;
        let limits = velocity.iter().zip(acceleration).zip(jerk);
        let takes = from.iter().zip(self.q).zip(limits).map(|((at, q), ((v, a), j))| {
            // Up to speed and back, twice where it goes the other way, and what is between.
            (at.q - q).abs() / v + 3.0 * (v / a + a / j)
        });
        let most = PARK_TIMES * takes.fold(0.0, f64::max) * 1e9 + PARK_NS;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive; what is too large is most"
        )]
        let samples = (most / period_ns.max(1) as f64) as u64;
        samples
    }
}

/// Returns true if the arm follows its motion without a fault.
fn is_well(report: Option<&Report>) -> bool {
    report.is_some_and(|report| report.mode == Mode::Tracking && report.fault.is_none())
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

/// Returns true if a stop is complete: the supervisor requests the brakes or is idle, or there is none.
fn is_stopped(report: Option<&Report>) -> bool {
    report.is_none_or(|report| report.brake || report.mode == Mode::Idle)
}

#[cfg(test)]
mod tests {
    use super::{Arrival, DeskVelocity};
    use phihat::{VelocityFilter, VelocityState};

    /// Wrong if the robot's own velocity reached the law over a sample that was lost, or if the one after it were
    /// differenced over one period only.
    #[test]
    fn a_lost_sample_keeps_the_differenced_velocity() {
        let filter = VelocityFilter::new(None, 1e-3).unwrap();
        let states = vec![VelocityState::default()];
        let mut velocity = DeskVelocity { filter, states, last_ns: 0 };
        let mut at = |t_ns: u64, arrival: Arrival, q: f64| {
            let mut sample = phihat_sim::Sample::of(1);
            (sample.joints[0].q, sample.joints[0].dq) = (q, 9.0);
            velocity.estimate(t_ns, arrival, &mut sample);
            sample.joints[0].dq
        };
        assert_eq!(at(0, Arrival::Lost, 0.0).to_bits(), 0.0_f64.to_bits());
        assert_eq!(at(1_000_000, Arrival::Fresh, 0.5).to_bits(), 0.0_f64.to_bits());
        assert!((at(2_000_000, Arrival::Fresh, 0.501) - 1.0).abs() < 1e-9);
        // The same positions once more, as a link leaves them.
        assert!((at(3_000_000, Arrival::Lost, 0.501) - 1.0).abs() < 1e-9);
        assert!((at(4_000_000, Arrival::Fresh, 0.505) - 2.0).abs() < 1e-9);
    }
}
