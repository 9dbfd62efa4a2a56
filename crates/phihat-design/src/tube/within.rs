//! Changes within a sample that the arm has and linear runs do not.

use phihat_certificate::extremes::{Extremes as _, larger};

use super::along::Along;
use super::linear::Derivatives;
use super::shapes::LinearRun;

/// Largest change of what is held, from sample to sample in a bin.
///
/// A torque that goes on by `Δ` per sample, held at its middle, ends `T²/12 M⁻¹ Δ` elsewhere; of its bend
/// `Δ²` the mean lacks `Δ²/24`.
pub(super) struct Within {
    /// `|Δ|` of what the payload does to each torque \[N·m\].
    pub(super) slope: Vec<f64>,
    /// `|Δ²|` of the same.
    pub(super) bend: Vec<f64>,
    /// `|ΔD|` and `|ΔK|`, entry by entry.
    pub(super) damping: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
}

impl Within {
    /// Over the samples of a bin, the first of the next included.
    pub(super) fn of(along: &Along<'_>, (from, to): (usize, usize)) -> Self {
        let (n, intervals) = (along.course.scene.n, along.course.intervals);
        let end = (to + 1).min(intervals.len());
        let change = |shape: &LinearRun, k: usize, i: usize| shape.change(k, (i, n));
        let slope =
            |i: usize| (from..end).map(|k| along.pushed(|shape| change(shape, k, i))).largest();
        let bend = |i: usize| {
            let twice = |shape: &LinearRun, k: usize| change(shape, k, i) - change(shape, k - 1, i);
            (from.max(2)..end).map(|k| along.pushed(|shape| twice(shape, k))).largest()
        };
        let moved = |of: fn(&Derivatives) -> &[f64]| -> Vec<f64> {
            let pairs = intervals[from.max(1) - 1..end].windows(2);
            let mut most = vec![0.0_f64; n * n];
            for pair in pairs {
                let [before, now] = [0, 1].map(|k| of(&pair[k].derivatives));
                for (most, (now, before)) in most.iter_mut().zip(now.iter().zip(before)) {
                    *most = larger(*most, (now - before).abs());
                }
            }
            most
        };
        Self {
            slope: (0..n).map(slope).collect(),
            bend: (0..n).map(bend).collect(),
            damping: moved(|at| &at.d),
            stiffness: moved(|at| &at.k),
        }
    }
}
