//! What a run came to.

use phihat::{Events, Mode};
use phihat_model::{Joint, JointKind, Robot};
use phihat_sim::{Motion, Outcome, Supervision, Survival, Trace};
use phihat_study::Study;
use serde::{Deserialize, Serialize};

use super::case::Case;
use super::matrix::{Matrix, RunError};

/// Most samples from the reason of a stop to the stop.
pub const STOP_SAMPLES: u64 = 3;

/// How long brakes take to close \[s\]: what the arm does after that is not judged.
pub const BRAKE_S: f64 = 0.05;

/// How far ahead on its planned path an arm may come to rest \[s\].
const BRAKING_S: f64 = 0.3;

/// What a guard says of a sample that is not as it should be.
const NOTICES: [Events; 7] = [
    Events::MISSED,
    Events::DUPLICATE,
    Events::REORDERED,
    Events::AGED,
    Events::TIME_JUMP,
    Events::NOT_FINITE,
    Events::IMPLAUSIBLE,
];

/// The unit of an arm whose joints turn.
fn turning() -> String {
    "mrad".to_owned()
}

/// The unit of an arm's joints, for people.
fn way_unit(robot: &Robot) -> String {
    let slides = |joint: &Joint| joint.kind == JointKind::Prismatic;
    match (robot.joints.iter().all(slides), robot.joints.iter().any(slides)) {
        (true, _) => "mm".to_owned(),
        (false, true) => "mrad or mm".to_owned(),
        (false, false) => turning(),
    }
}

/// What a run of the matrix came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// When the fault began \[s\].
    pub onset_s: f64,
    /// The joint it was about, where it is about one.
    pub joint: String,
    /// Why it could not run at all.
    pub refused: Option<String>,
    /// Whether the arm and every torque stayed finite.
    pub finite: bool,
    /// Whether no drive was told more than the torque limit.
    pub torque_kept: bool,
    /// Whether no drive was told to change its torque faster than the rate limit.
    pub rate_kept: bool,
    /// What the controller noticed first, and when after the onset \[ms\].
    pub noticed: Option<(String, f64)>,
    /// Why it stopped, and when after the onset \[ms\]; before it: a false alarm.
    pub stopped: Option<(String, f64)>,
    /// Samples from the stop's reason to the stop.
    pub stop_delay: Option<u64>,
    /// Why the robot itself stopped, if it did.
    pub robot_stopped: Option<String>,
    /// In which unit a person reads an arm's excursion and error: mrad, mm of joints that slide, or both where it has both.
    #[serde(default = "turning")]
    pub way_unit: String,
    /// Largest excursion from the onset until the brakes have closed \[rad\].
    pub excursion_rad: f64,
    /// Largest error over the last tenth of the run \[rad\].
    pub error_end_rad: f64,
}

impl Matrix {
    /// Runs a case.
    pub fn run(&self, case: &Case) -> Cell {
        match self.outcome(case) {
            Ok((study, outcome)) => self.observe(case, &study, &outcome),
            Err(why) => Cell { refused: Some(why.to_string()), ..self.nothing(case) },
        }
    }

    fn outcome(&self, case: &Case) -> Result<(Box<Study>, Outcome), RunError> {
        let study = self.study(case)?;
        let outcome = self.build(case, &study)?.run(|_| ());
        Ok((study, outcome))
    }

    fn nothing(&self, case: &Case) -> Cell {
        let draw = self.draw(case);
        let robot = &self.arms[case.arm].orders[0].1.robot;
        Cell {
            onset_s: draw.onset,
            joint: robot.joints[draw.joint].name.clone(),
            way_unit: way_unit(robot),
            refused: None,
            finite: false,
            torque_kept: false,
            rate_kept: false,
            noticed: None,
            stopped: None,
            stop_delay: None,
            robot_stopped: None,
            excursion_rad: 0.0,
            error_end_rad: 0.0,
        }
    }

    fn observe(&self, case: &Case, study: &Study, outcome: &Outcome) -> Cell {
        let survival = Survival::of(outcome, study);
        let trace = &outcome.trace;
        let onset = trace.index_at(self.draw(case).onset);
        let after = |k: usize| (k as f64 - onset as f64) * trace.period_ns as f64 * 1e-6;
        let watch = trace.supervision.as_ref().map(Watch);
        let stop = watch.as_ref().and_then(Watch::stop);
        let fault = |k: usize| watch.as_ref().map_or("", |watch| watch.reason(k)).to_owned();
        let noticed = watch.as_ref().and_then(|watch| watch.notice(onset));
        let torques = trace.joints.iter().flat_map(|joint| &joint.tau_command);
        Cell {
            finite: survival.finite && torques.copied().all(f64::is_finite),
            torque_kept: survival.torque_kept,
            rate_kept: survival.torque_rate_kept,
            noticed: noticed.map(|(what, k)| (what, after(k))),
            stopped: stop.map(|k| (fault(k), after(k))),
            stop_delay: watch.as_ref().and_then(Watch::delay),
            robot_stopped: outcome.abort.as_ref().map(|abort| abort.reason.to_string()),
            excursion_rad: excursion(
                study,
                trace,
                onset.max(trace.index_at(study.spec.settle)),
                stop,
            ),
            error_end_rad: survival.error_end_rad,
            ..self.nothing(case)
        }
    }
}

/// What the supervisor of a run saw.
struct Watch<'a>(&'a Supervision);

impl Watch<'_> {
    /// The first thing noticed from a sample on, and at which sample.
    fn notice(&self, from: usize) -> Option<(String, usize)> {
        (from..self.0.events.len()).find_map(|k| {
            let event = NOTICES.iter().rev().find(|event| self.0.events[k].contains(**event));
            let what = match (self.0.fault[k], event) {
                (Some(fault), _) => fault.name().to_owned(),
                (None, Some(event)) => event.names().collect::<Vec<_>>().join(" "),
                (None, None) => return None,
            };
            Some((what, k))
        })
    }

    fn stop(&self) -> Option<usize> {
        self.0.mode.iter().position(|mode| *mode == Mode::SafeStop)
    }

    fn reason(&self, k: usize) -> &'static str {
        self.0.fault[k].map_or("asked", phihat::Fault::name)
    }

    /// Samples from the first reason to the stop; `None` where there was no reason.
    fn delay(&self) -> Option<u64> {
        let reason = self.0.fault.iter().position(Option::is_some)?;
        let stop = self.stop().unwrap_or(self.0.mode.len());
        Some(stop.saturating_sub(reason) as u64)
    }
}

/// Largest distance from the reference while the arm follows; in a stop, from the stretch of the planned path on
/// which it may come to rest, until the brakes have closed.
fn excursion(study: &Study, trace: &Trace, from: usize, stop: Option<usize>) -> f64 {
    let follows = |k: usize| {
        let mode = trace.supervision.as_ref().map(|watch| watch.mode[k]);
        matches!(mode, None | Some(Mode::Tracking | Mode::Holding))
    };
    let errors = trace.joints.iter().flat_map(|joint| joint.e.iter().enumerate().skip(from));
    let following = errors.filter(|(k, _)| follows(*k));
    let worst = following.fold(0.0, |most: f64, (_, e)| most.max(e.abs()));
    worst.max(stop.map_or(0.0, |stop| overrun(study, trace, stop.max(from), stop)))
}

/// The part of the excursion in the first stop.
fn overrun(study: &Study, trace: &Trace, from: usize, stop: usize) -> f64 {
    let Some(watch) = &trace.supervision else { return 0.0 };
    let Ok(motion) = Motion::new(&study.reference, &study.robot, study.duration) else {
        return 0.0;
    };
    let period = trace.period_ns as f64 * 1e-9;
    // The reference's clock runs while the arm tracks.
    let tracked = watch.mode[..stop].iter().filter(|mode| **mode == Mode::Tracking).count();
    let begun = tracked as f64 * period;
    let braked = watch.brake.iter().skip(stop).position(|brake| *brake).map(|k| stop + k);
    let closed = braked.map_or(trace.len() as f64, |k| k as f64 + BRAKE_S / period);
    let in_stop = |k: usize| watch.mode[k] == Mode::SafeStop && (k as f64) < closed;
    let mut worst: f64 = 0.0;
    for (i, joint) in trace.joints.iter().enumerate() {
        let at = |step: i32| motion.at(i, begun + f64::from(step) * BRAKING_S / 30.0)[0];
        let low = (0..=30).map(at).fold(f64::INFINITY, f64::min);
        let high = (0..=30).map(at).fold(f64::NEG_INFINITY, f64::max);
        let stopping = joint.q.iter().enumerate().skip(from).filter(|(k, _)| in_stop(*k));
        worst = stopping.fold(worst, |most, (_, q)| most.max(low - q).max(q - high));
    }
    worst
}
