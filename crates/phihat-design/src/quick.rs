//! Estimates of the sampled gains, cheap enough for a search; the certificate proves the real ones.

use nalgebra::DVector;

use crate::gains::JointRecord;
use crate::sampled::{LoopModel, StateMatrix};

/// Samples after which a response is cut off, should it not have died before.
const LONGEST: usize = 40_000;

/// A response has died when it stays below this share of its largest value …
const DEAD: f64 = 1e-4;

/// … for so many samples.
const QUIET: usize = 64;

/// Peak-to-peak gains at one inertia ratio, in units of `M̄`; a few per mille low.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Quick {
    /// From `φ/M̄` to `e`, `ė`.
    pub(crate) jump: [f64; 2],
    /// From `φ̇/M̄` to `e`, `ė`.
    pub(crate) ramp: [f64; 2],
    /// From the encoder's error to `e`, `ė`.
    pub(crate) reading: [f64; 2],
    /// From the encoder's error to the change of torque per sample, over `M̄`.
    pub(crate) change: f64,
}

impl Quick {
    /// `None` when a response does not die.
    pub(crate) fn at(law: &JointRecord, model: &LoopModel, mu: f64) -> Option<Self> {
        let matrix = StateMatrix::new(law, model, mu);
        let mut quick = Self::default();
        let mut sums = [0.0; 2];
        let unit = matrix.unit();
        walk(&matrix, matrix.disturbance(), |x| {
            for (i, value) in [x[0], unit * x[1]].into_iter().enumerate() {
                quick.jump[i] += value.abs();
                sums[i] += value;
                quick.ramp[i] += sums[i].abs() * model.period_s;
            }
        })?;
        let encoder = matrix.encoder();
        let mut last = encoder.direct;
        quick.change = last.abs();
        walk(&matrix, &encoder.drives, |x| {
            quick.reading[0] += x[0].abs();
            quick.reading[1] += (unit * x[1]).abs();
            let torque = (&encoder.state * x)[0];
            quick.change += (torque - last).abs();
            last = torque;
        })?;
        Some(quick)
    }

    /// The larger of each.
    pub(crate) fn worse(self, other: Self) -> Self {
        let two = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        Self {
            jump: two(self.jump, other.jump),
            ramp: two(self.ramp, other.ramp),
            reading: two(self.reading, other.reading),
            change: self.change.max(other.change),
        }
    }
}

/// Shows `b, Ab, A²b, …` until it has died; `None` when it does not.
fn walk(
    matrix: &StateMatrix,
    b: &DVector<f64>,
    mut visit: impl FnMut(&DVector<f64>),
) -> Option<()> {
    let a = matrix.matrix();
    let mut x = b.clone();
    let mut next = x.clone();
    let (mut largest, mut quiet) = (0.0_f64, 0);
    for _ in 0..LONGEST {
        visit(&x);
        let size = x.amax();
        largest = largest.max(size);
        quiet = if size < DEAD * largest { quiet + 1 } else { 0 };
        if quiet > QUIET {
            return Some(());
        }
        next.gemv(1.0, a, &x, 0.0);
        core::mem::swap(&mut x, &mut next);
    }
    None
}
