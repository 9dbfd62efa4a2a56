//! The signals of a run as its page holds them: every sample, or of a long run the least and the largest of each few.

mod bits;
mod code;

use crate::kind::{CHARTS, KindCurve};
use code::Coded;

/// Values that a page holds: some 3 MB where every one is noise.
const VALUES_MAX: u64 = 1_200_000;

/// Every curve that some chart shows, once, with the factor from SI units.
pub(crate) fn sources() -> Vec<(&'static KindCurve, f64)> {
    let mut sources: Vec<(&'static KindCurve, f64)> = Vec::new();
    for (kind, curve) in CHARTS.iter().flat_map(|kind| kind.curves.iter().map(move |c| (kind, c))) {
        if !sources.iter().any(|(seen, _)| seen.label == curve.label) {
            sources.push((curve, kind.scale));
        }
    }
    sources
}

/// One signal of one joint.
#[derive(Debug, Clone)]
pub(crate) struct CodedSignal {
    /// Samples that share a value; 1: each has its own.
    each: u64,
    seen: u64,
    ends: Option<(f64, f64)>,
    low: Coded,
    high: Coded,
}

impl CodedSignal {
    /// A signal of a run of so many samples and joints.
    pub(crate) fn new(samples: u64, joints: usize) -> Self {
        let (low, high) = (Coded::default(), Coded::default());
        Self { each: each(samples, joints), seen: 0, ends: None, low, high }
    }

    /// The next sample.
    pub(crate) fn push(&mut self, value: f64) {
        if self.each == 1 {
            self.low.push(value);
            return;
        }
        if value.is_finite() {
            let (low, high) = self.ends.unwrap_or((value, value));
            self.ends = Some((low.min(value), high.max(value)));
        }
        self.seen += 1;
        if self.seen == self.each {
            self.close();
        }
    }

    fn close(&mut self) {
        let (low, high) = self.ends.take().unwrap_or((f64::NAN, f64::NAN));
        self.low.push(low);
        self.high.push(high);
        self.seen = 0;
    }

    /// As the page reads it: every sample, or the least and the largest of each few.
    pub(crate) fn texts(&self) -> Vec<String> {
        if self.each == 1 {
            return vec![self.low.text()];
        }
        let mut whole = self.clone();
        if whole.seen > 0 {
            whole.close();
        }
        vec![whole.low.text(), whole.high.text()]
    }

    /// The signal, one value of each few samples.
    pub(crate) fn values(&self) -> Vec<f64> {
        self.low.values()
    }
}

/// Number of samples that share a value, so that the page stays small.
pub(crate) fn each(samples: u64, joints: usize) -> u64 {
    let values = samples.saturating_mul(joints as u64).saturating_mul(sources().len() as u64);
    if values <= VALUES_MAX { 1 } else { (2 * values).div_ceil(VALUES_MAX) }
}

/// When the samples were taken: `(k, t, step)`, from sample `k` at time `t` \[ns\] on one each `step` \[ns\].
#[derive(Debug, Clone, Default)]
pub(crate) struct SampleTimes {
    runs: Vec<(u64, u64, u64)>,
    last: Option<(u64, u64)>,
}

impl SampleTimes {
    /// The next sample.
    pub(crate) fn push(&mut self, k: u64, t_ns: u64) {
        if let (Some((before, at)), Some(run)) = (self.last, self.runs.last_mut()) {
            let step = t_ns.saturating_sub(at);
            if before == run.0 {
                run.2 = step;
            } else if run.2 != step {
                self.runs.push((before, at, step));
            }
        } else {
            self.runs.push((k, t_ns, 0));
        }
        self.last = Some((k, t_ns));
    }

    pub(crate) fn runs(&self) -> &[(u64, u64, u64)] {
        &self.runs
    }
}
