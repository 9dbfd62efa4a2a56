//! Figures of a faulted run, computed from its record block by block.

use core::convert::Infallible;

use phihat::{Events, Mode};
use phihat_sim::{Motion, Recorder, Supervision, Trace};
use phihat_study::Study;

/// Closing time of the brakes \[s\]; the motion after it is not judged.
pub const BRAKE_S: f64 = 0.05;

/// Time ahead on its planned path within which an arm may come to rest \[s\].
const BRAKING_S: f64 = 0.3;

/// Events by which a guard reports an invalid sample.
const NOTICES: [Events; 7] = [
    Events::MISSED,
    Events::DUPLICATE,
    Events::REORDERED,
    Events::AGED,
    Events::TIME_JUMP,
    Events::NOT_FINITE,
    Events::IMPLAUSIBLE,
];

/// The figures of a run so far. Samples are counted from 0.
#[derive(Debug)]
pub(super) struct FaultObservations<'a> {
    study: &'a Study,
    /// The fault's first sample, and the first whose excursion counts; beyond the end if it ends before.
    onset: usize,
    from: usize,
    samples: usize,
    finite: bool,
    noticed: Option<(String, usize)>,
    /// The first sample with a reason to stop.
    reason: Option<usize>,
    stop: Option<Stop>,
    /// Samples in which the reference's clock ran, before the stop.
    tracked: usize,
    excursion: f64,
}

/// The first stop.
#[derive(Debug)]
struct Stop {
    at: usize,
    why: &'static str,
    /// Sample at which the brakes were requested.
    braked: Option<usize>,
    /// Lowest and highest position of each joint on the stretch of the planned path on which it may come to rest.
    stretch: Option<Vec<(f64, f64)>>,
}

impl<'a> FaultObservations<'a> {
    /// Before the first sample of a run whose fault begins at a time \[s\].
    pub(super) fn new(study: &'a Study, onset: f64) -> Self {
        let onset = sample_at(study, onset);
        let from = onset.max(sample_at(study, study.spec.settle));
        Self {
            study,
            onset,
            from,
            samples: 0,
            finite: true,
            noticed: None,
            reason: None,
            stop: None,
            tracked: 0,
            excursion: 0.0,
        }
    }

    /// Returns true if every commanded torque was finite.
    pub(super) fn is_finite(&self) -> bool {
        self.finite
    }

    /// First event detected from the onset on, and its time after the onset \[ms\].
    pub(super) fn noticed(&self) -> Option<(String, f64)> {
        self.noticed.as_ref().map(|(what, k)| (what.clone(), self.after(*k)))
    }

    /// Why it stopped, and when after the onset \[ms\].
    pub(super) fn stopped(&self) -> Option<(String, f64)> {
        self.stop.as_ref().map(|stop| (stop.why.to_owned(), self.after(stop.at)))
    }

    /// Samples from the first reason to the stop; `None` where there was no reason.
    pub(super) fn delay(&self) -> Option<u64> {
        let stop = self.stop.as_ref().map_or(self.samples, |stop| stop.at);
        self.reason.map(|reason| stop.saturating_sub(reason) as u64)
    }

    /// Largest distance from the reference while the arm follows; in a stop, from the stretch of the planned path on
    /// which it may come to rest, until the brakes have closed.
    pub(super) fn excursion(&self) -> f64 {
        self.excursion
    }

    fn after(&self, k: usize) -> f64 {
        let onset = self.onset.min(self.samples);
        (k as f64 - onset as f64) * self.study.control.period_ns as f64 * 1e-6
    }

    /// Sample `k` of the run, at `at` in the block.
    fn watch(&mut self, k: usize, (at, block): (usize, &Trace), watch: &Supervision) {
        let (mode, fault) = (watch.mode[at], watch.fault[at]);
        if self.noticed.is_none() && k >= self.onset {
            let event = NOTICES.iter().rev().find(|event| watch.events[at].contains(**event));
            let what = match (fault, event) {
                (Some(fault), _) => Some(fault.name().to_owned()),
                (None, Some(event)) => Some(event.names().collect::<Vec<_>>().join(" ")),
                (None, None) => None,
            };
            self.noticed = what.map(|what| (what, k));
        }
        if fault.is_some() {
            self.reason.get_or_insert(k);
        }
        if self.stop.is_none() && mode == Mode::SafeStop {
            let why = fault.map_or("asked", phihat::Fault::name);
            let stretch = stretch(self.study, block.joints.len(), self.tracked);
            self.stop = Some(Stop { at: k, why, braked: None, stretch });
        }
        self.tracked += usize::from(mode == Mode::Tracking && self.stop.is_none());
        let period = self.study.control.period_ns as f64 * 1e-9;
        let Some(stop) = &mut self.stop else { return };
        if watch.brake[at] {
            stop.braked.get_or_insert(k);
        }
        let open = stop.braked.is_none_or(|b| (k as f64) < b as f64 + BRAKE_S / period);
        let Some(stretch) = &stop.stretch else { return };
        if mode == Mode::SafeStop && open && k >= self.from {
            let beyond = stretch.iter().zip(&block.joints).map(|((low, high), joint)| {
                let q = joint.q[at];
                (low - q).max(q - high)
            });
            self.excursion = beyond.fold(self.excursion, f64::max);
        }
    }
}

impl Recorder for FaultObservations<'_> {
    type Error = Infallible;

    fn take(&mut self, block: &mut Trace) -> Result<(), Infallible> {
        let mut torques = block.joints.iter().flat_map(|joint| &joint.tau_command);
        self.finite &= torques.all(|torque| torque.is_finite());
        for at in 0..block.len() {
            let k = self.samples;
            let mut follows = true;
            if let Some(watch) = &block.supervision {
                self.watch(k, (at, block), watch);
                follows = matches!(watch.mode[at], Mode::Tracking | Mode::Holding);
            }
            if follows && k >= self.from {
                let errors = block.joints.iter().map(|joint| joint.e[at].abs());
                self.excursion = errors.fold(self.excursion, f64::max);
            }
            self.samples += 1;
        }
        Ok(())
    }
}

/// The first sample at or after a time \[s\].
fn sample_at(study: &Study, t: f64) -> usize {
    let period = study.control.period_ns;
    let all = phihat_sim::samples(study.duration, period);
    let (mut low, mut high) = (0, all);
    while low < high {
        let middle = low.midpoint(high);
        if ((middle * period) as f64) < t * 1e9 { low = middle + 1 } else { high = middle }
    }
    usize::try_from(low).unwrap_or(usize::MAX)
}

/// Lowest and highest position at which each joint may come to rest in a stop after `tracked` samples on the
/// reference.
fn stretch(study: &Study, joints: usize, tracked: usize) -> Option<Vec<(f64, f64)>> {
    let motion = Motion::new(&study.reference, &study.robot, study.duration).ok()?;
    let begun = tracked as f64 * study.control.period_ns as f64 * 1e-9;
    let ends = |joint: usize| {
        let at = |step: i32| motion.at(joint, begun + f64::from(step) * BRAKING_S / 30.0)[0];
        let low = (0..=30).map(at).fold(f64::INFINITY, f64::min);
        (low, (0..=30).map(at).fold(f64::NEG_INFINITY, f64::max))
    };
    Some((0..joints).map(ends).collect())
}
