//! Samples of a run that are drawn, chosen as its record passes.

use core::ops::Range;

use phihat_sim::{JointTrace, Trace};

use crate::arm::DrawnArm;
use crate::kind::{CHARTS, ChartKind, DRAWABLE_MAX, PlotPlane};
use crate::signal::{self, CodedSignal, SampleTimes};
use crate::stretches::{CURVES, ChartSample, Stretches};
use crate::supervision::ModeHistory;

/// Stretches kept per panel of a static figure: two pixels each where a panel has half the width.
const BUCKETS: usize = 220;

/// Part of a run that a page and its figures show: bounded in size, however long the record was.
#[derive(Debug, Clone)]
pub struct Drawing {
    /// Of the static figures, per chart and joint.
    chosen: Vec<Vec<ChartSamples>>,
    /// Of the page, per joint, in the order of [`signal::sources`].
    pub(crate) signals: Vec<Vec<CodedSignal>>,
    /// Number of samples that share a value of them.
    pub(crate) each: u64,
    pub(crate) times: SampleTimes,
    pub(crate) arm: Option<DrawnArm>,
    /// The command before, per joint.
    tau: Vec<Option<f64>>,
    pub(crate) joints: Vec<String>,
    pub(crate) course: ModeHistory,
    /// Samples of the run.
    pub(crate) samples: u64,
    /// Time of the last one \[s\].
    pub(crate) end_s: f64,
    /// Values that are drawn as gaps.
    pub(crate) undrawable: usize,
}

/// One chart of one joint.
#[derive(Debug, Clone)]
struct ChartSamples {
    figure: Stretches,
    steady: Option<Stretches>,
}

/// The samples of one chart of one joint that a static figure draws.
#[derive(Debug, Clone)]
pub(crate) struct DrawnSamples {
    /// Of the static figure.
    pub figure: Vec<ChartSample>,
    /// Of the static figure of the steady part, where there is one.
    pub steady: Vec<ChartSample>,
}

impl Drawing {
    /// A drawing before the first sample of a run of so many joints, with this period \[ns\], number of samples, and
    /// beginning of its steady part \[s\].
    #[must_use]
    pub fn new(joints: Vec<String>, period_ns: u64, samples: u64, settle_s: f64) -> Self {
        let (mut settle, mut begun) = (0, samples);
        while settle < begun {
            let middle = settle + (begun - settle) / 2;
            if ((middle * period_ns) as f64 * 1e-9) < settle_s {
                settle = middle + 1;
            } else {
                begun = middle;
            }
        }
        Self::parted(joints, settle, samples)
    }

    /// The drawing of a whole record whose steady part begins at a time \[s\].
    #[must_use]
    pub fn of(trace: &Trace, settle_s: f64) -> Self {
        let names = trace.joints.iter().map(|joint| joint.name.clone()).collect();
        let settle = trace.t_ns.partition_point(|&t| (t as f64 * 1e-9) < settle_s);
        let mut drawing = Self::parted(names, settle as u64, trace.t_ns.len() as u64);
        drawing.block(trace);
        drawing
    }

    /// The same with the arm, to be seen as it moves.
    #[must_use]
    pub fn with_arm(mut self, arm: DrawnArm) -> Self {
        self.arm = Some(arm);
        self
    }

    fn parted(joints: Vec<String>, settle: u64, samples: u64) -> Self {
        let steady = settle.min(samples)..samples;
        let start = 0..steady.start;
        let chosen = |kind: &ChartKind| {
            let figure = if kind.plane == PlotPlane::Phase { start.clone() } else { 0..samples };
            let cut = |part: &Range<u64>, count| Stretches::new(part.clone(), count);
            ChartSamples {
                figure: cut(&figure, BUCKETS),
                steady: kind.steady.is_some().then(|| cut(&steady, BUCKETS)),
            }
        };
        let signals = vec![CodedSignal::new(samples, joints.len()); signal::sources().len()];
        Self {
            signals: vec![signals; joints.len()],
            each: signal::each(samples, joints.len()),
            times: SampleTimes::default(),
            arm: None,
            chosen: CHARTS.iter().map(|kind| vec![chosen(kind); joints.len()]).collect(),
            tau: vec![None; joints.len()],
            joints,
            course: ModeHistory::default(),
            samples: 0,
            end_s: 0.0,
            undrawable: 0,
        }
    }

    /// Chooses what is drawn of the next samples.
    pub fn block(&mut self, trace: &Trace) {
        for (j, joint) in trace.joints.iter().enumerate() {
            let before = self.tau.get(j).copied().flatten();
            let own = self.signals.get_mut(j).map_or(&mut [][..], |signals| &mut signals[..]);
            for ((curve, scale), signal) in signal::sources().iter().zip(own) {
                let values = (0..trace.t_ns.len()).map(|i| scale * (curve.of)(joint, i, before));
                values.for_each(|value| signal.push(drawable(value)));
            }
            for (kind, chosen) in CHARTS.iter().zip(&mut self.chosen) {
                let Some(chosen) = chosen.get_mut(j) else { continue };
                for (i, t_ns) in trace.t_ns.iter().enumerate() {
                    let mut y = [f64::NAN; CURVES];
                    for (y, curve) in y.iter_mut().zip(kind.curves) {
                        *y = drawable(kind.scale * (curve.of)(joint, i, before));
                    }
                    let row = ChartSample { k: self.samples + i as u64, t: *t_ns as f64 * 1e-9, y };
                    chosen.push(row);
                }
            }
            self.undrawable += undrawable(joint);
            if let Some(tau) = self.tau.get_mut(j) {
                *tau = joint.tau_command.last().copied().or(*tau);
            }
        }
        self.course.block(trace);
        (self.samples..).zip(&trace.t_ns).for_each(|(k, t)| self.times.push(k, *t));
        self.samples += trace.t_ns.len() as u64;
        self.end_s = trace.t_ns.last().map_or(self.end_s, |t| *t as f64 * 1e-9);
    }

    /// Samples that are drawn of each chart, per joint.
    pub(crate) fn drawn(&self) -> impl Iterator<Item = Vec<DrawnSamples>> {
        self.chosen.iter().map(|joints| joints.iter().map(ChartSamples::drawn).collect())
    }
}

impl ChartSamples {
    fn push(&mut self, row: ChartSample) {
        self.figure.push(row);
        self.steady.iter_mut().for_each(|part| part.push(row));
    }

    fn drawn(&self) -> DrawnSamples {
        DrawnSamples {
            figure: self.figure.clone().finish(),
            steady: self.steady.clone().map(Stretches::finish).unwrap_or_default(),
        }
    }
}

fn drawable(value: f64) -> f64 {
    if value.abs() <= DRAWABLE_MAX { value } else { f64::NAN }
}

fn undrawable(joint: &JointTrace) -> usize {
    let JointTrace { q, q_desired, e, de, tau_command, tau_applied, phi, phi_hat, .. } = joint;
    let columns = [q, q_desired, e, de, tau_command, tau_applied, phi, phi_hat];
    let gaps = columns.iter().flat_map(|column| column.iter());
    gaps.filter(|value| value.is_nan() || value.abs() > DRAWABLE_MAX).count()
}
