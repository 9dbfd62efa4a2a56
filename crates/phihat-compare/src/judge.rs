//! Outcome of a run, its figures, and its trace in few numbers.

use phihat_campaign::statistics::rms;
use phihat_sim::{JointTrace, SimulationOutcome, Trace};
use phihat_study::Study;

use crate::motion::amplitudes;
use crate::protocol::noise_above;
use crate::run_outcome::{Figures, RunOutcome, Sketch};

/// Slices of a sketch.
const SLICES: usize = 60;

/// An error of this share of a joint's own motion is not following.
const LOST: f64 = 1.0;

/// Bounds that a run is judged by.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bars<'a> {
    /// Largest |e| of the specification \[rad\] per joint.
    pub(crate) error_bound: &'a [f64],
    /// The arm's own torque limits \[N·m\] per joint.
    pub(crate) limits: &'a [f64],
    /// |e| stated before the run \[rad\] per joint, if it was.
    pub(crate) bound: Option<&'a [f64]>,
}

/// Judges a run. `broken`: when and at which joint the rival's torque was no number.
pub(crate) fn judge(
    study: &Study,
    outcome: &SimulationOutcome,
    broken: Option<(f64, usize)>,
    bars: &Bars<'_>,
) -> (RunOutcome, Option<Figures>) {
    let trace = &outcome.trace;
    let joint = |i: usize| study.robot.joints[i].name.clone();
    if let Some((t, i)) = broken {
        return (RunOutcome::NotFinite { t, joint: joint(i) }, None);
    }
    if let Some(divergence) = &outcome.divergence {
        return (RunOutcome::Diverged { t: divergence.t, joint: divergence.joint.clone() }, None);
    }
    if let Some(abort) = &outcome.abort {
        return (RunOutcome::Refused(format!("the robot stopped: {}", abort.reason)), None);
    }
    let figures = figures(study, trace, bars);
    let from = trace.index_at(study.spec.settle);
    let amplitudes = amplitudes(study).unwrap_or_default();
    let lost = (0..trace.joints.len()).find(|&i| {
        let error = largest(&trace.joints[i].e[from..]);
        amplitudes.get(i).is_some_and(|amplitude| error >= LOST * amplitude)
    });
    match lost {
        Some(i) => (RunOutcome::Lost { joint: joint(i) }, Some(figures)),
        None => (RunOutcome::Followed, Some(figures)),
    }
}

fn figures(study: &Study, trace: &Trace, bars: &Bars<'_>) -> Figures {
    let from = trace.index_at(study.spec.settle);
    let over = |of: &dyn Fn(usize, &JointTrace) -> f64| {
        let each = trace.joints.iter().enumerate().map(|(i, joint)| of(i, joint));
        each.fold(0.0, f64::max)
    };
    let scored = |values: &[f64]| values[from..].to_vec();
    let bound = bars.bound.and_then(|bound| tightest(trace, from, bound));
    let met = |k: usize| trace.joints.iter().any(|joint| joint.saturated[k]);
    let count = (from..trace.len()).filter(|&k| met(k)).count();
    Figures {
        error_rms_rad: over(&|_, joint| rms(&scored(&joint.e))),
        error_peak_rad: over(&|_, joint| largest(&joint.e[from..])),
        error_over_spec: over(&|i, joint| largest(&joint.e[from..]) / bars.error_bound[i]),
        effort: over(&|i, joint| rms(&scored(&joint.tau_applied)) / bars.limits[i]),
        chatter_nm: over(&|_, joint| mean_step(&joint.tau_command[from..])),
        chatter_over_exact: None,
        noise: over(&|i, joint| noise(&joint.tau_command[from..]) / bars.limits[i]),
        noise_above_50_hz: loudest(trace, from, bars.limits),
        saturated: count as f64 / (trace.len() - from).max(1) as f64,
        recovery_s: recovery(study, trace, from, bars.error_bound),
        error_bound_rad: bound.map(|(bound, _)| bound),
        bound_over_measured: bound.map(|(_, ratio)| ratio),
    }
}

/// The largest of the joints' noise above 50 Hz over their limits.
fn loudest(trace: &Trace, from: usize, limits: &[f64]) -> Option<f64> {
    let period = trace.period_ns as f64 * 1e-9;
    let joints = trace.joints.iter().zip(limits);
    let each =
        joints.map(|(joint, limit)| Some(noise_above(&joint.tau_applied, from, period)? / limit));
    each.collect::<Option<Vec<f64>>>()?.into_iter().reduce(f64::max)
}

/// The bound that the measured error comes closest to, and bound/measured.
fn tightest(trace: &Trace, from: usize, bound: &[f64]) -> Option<(f64, f64)> {
    let measured = trace.joints.iter().map(|joint| largest(&joint.e[from..]));
    let ratios = bound.iter().zip(measured).map(|(bound, e)| (*bound, bound / e.max(1e-12)));
    ratios.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// From the end of the last push until every error stays within twice what it was before, or its specification.
fn recovery(study: &Study, trace: &Trace, from: usize, error_bound: &[f64]) -> Option<f64> {
    let pushes = &study.world.pushes;
    let start = pushes.iter().map(|p| p.start).fold(f64::INFINITY, f64::min);
    let end = pushes.iter().map(|p| p.start + p.duration).fold(f64::NEG_INFINITY, f64::max);
    if !end.is_finite() {
        return None;
    }
    let (begun, ended) = (trace.index_at(start), trace.index_at(end));
    let mut back = ended;
    for (joint, error_bound) in trace.joints.iter().zip(error_bound) {
        let before = largest(&joint.e[from.min(begun)..begun]);
        let inside = |e: &f64| e.abs() <= (2.0 * before).max(*error_bound);
        let last = joint.e.iter().rposition(|e| !inside(e)).map_or(0, |k| k + 1);
        back = back.max(last);
    }
    let period = trace.period_ns as f64 * 1e-9;
    (back < trace.len()).then(|| (back - ended) as f64 * period)
}

/// Smallest and largest error and torque of the worst joint, in equal slices of time.
pub(crate) fn sketch(trace: &Trace) -> Option<Sketch> {
    let size = |joint: &&JointTrace| largest(&joint.e);
    let joint = trace.joints.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
    Some(Sketch {
        joint: joint.name.clone(),
        end_s: trace.len() as f64 * trace.period_ns as f64 * 1e-9,
        e_rad: slices(&joint.e),
        tau_nm: slices(&joint.tau_command),
    })
}

fn slices(values: &[f64]) -> Vec<[f32; 2]> {
    let n = values.len();
    let count = SLICES.min(n);
    let slice = |k: usize| {
        let part = &values[k * n / count..(k + 1) * n / count];
        let low = part.iter().copied().fold(f64::INFINITY, f64::min);
        let high = part.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        [round(low), round(high)]
    };
    (0..count).map(slice).collect()
}

/// Three digits: a picture needs no more.
fn round(value: f64) -> f32 {
    if value.abs() < 1e-30 || !value.is_finite() {
        return 0.0;
    }
    let unit = 10_f64.powf(value.abs().log10().floor() - 2.0);
    #[allow(clippy::cast_possible_truncation, reason = "for a picture")]
    let short = ((value / unit).round() * unit).clamp(-1e30, 1e30) as f32;
    short
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

fn mean_step(tau: &[f64]) -> f64 {
    let sum: f64 = tau.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    sum / (tau.len().saturating_sub(1)).max(1) as f64
}

/// White noise has this as its mean step; a smooth motion has next to none.
fn noise(tau: &[f64]) -> f64 {
    let sum: f64 = tau.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).sum();
    sum / (tau.len().saturating_sub(2)).max(1) as f64 / 3.0_f64.sqrt()
}
