//! One bin of the run: its samples, and the matrices that its inputs act through.

use phihat_certificate::extremes::{larger, smaller};

use super::guess::Guess;
use crate::tube::along::Along;
use crate::tube::group::BinGroup;
use crate::tube::kernel::KernelInputs;
use crate::tube::linear::StepInterval;
use crate::tube::products::times_abs;
use crate::tube::within::Within;

/// The stretch of the run that a bin covers.
#[derive(Clone, Copy)]
pub(super) struct SweepStretch<'a> {
    pub(super) along: &'a Along<'a>,
    pub(super) group: &'a BinGroup,
    pub(super) inputs: KernelInputs,
    /// Number of joints.
    pub(super) n: usize,
    /// The bin.
    pub(super) b: usize,
    /// First and last sample; the last one is the first of the next bin.
    pub(super) from: usize,
    pub(super) to: usize,
    /// The interval in the middle.
    pub(super) interval: &'a StepInterval,
    /// The payload's Jacobian in the middle; empty without one.
    pub(super) jacobian: &'a [f64],
    /// Changes over one of its samples of what linear runs hold.
    pub(super) within: &'a Within,
}

impl<'a> SweepStretch<'a> {
    pub(super) fn new(along: &'a Along<'a>, group: &'a BinGroup, b: usize) -> Self {
        let course = along.course;
        let (from, to) = along.samples(b);
        let middle = usize::midpoint(from, to);
        let inputs = course.inputs();
        let (interval, jacobian) = (course.interval(middle), course.jacobian(middle));
        let within = &group.within[b - group.bins.0];
        Self { along, group, inputs, n: inputs.n, b, from, to, interval, jacobian, within }
    }

    /// True velocity's ends in interval `k`, if the guess holds.
    pub(super) fn velocity(&self, guess: &Guess, k: usize, i: usize) -> (f64, f64) {
        let (n, from) = (self.n, self.from);
        let nominal = &self.along.nominal.dq;
        let (a, b) = (guess.v[(k - from) * n + i], guess.v[(k + 1 - from) * n + i]);
        let (v, w) = (nominal[k * n + i], nominal[(k + 1) * n + i]);
        (smaller(v + a.0, w + b.0), larger(v + a.1, w + b.1))
    }

    /// `|M⁻¹ x + M⁻¹ Jᵀ μ|`: what momentum is of a velocity at once.
    pub(super) fn direct(&self, momentum: &[f64], payload: &[f64]) -> Vec<f64> {
        let (n, inverse) = (self.n, &self.interval.inverse);
        let mut out = times_abs(inverse, momentum);
        for i in 0..n {
            for (mu, row) in payload.iter().zip(self.jacobian.chunks_exact(n)) {
                let entry: f64 = (0..n).map(|j| inverse[i * n + j] * row[j]).sum();
                out[i] += entry.abs() * mu;
            }
        }
        out
    }

    /// `|J M⁻¹ x| + |J M⁻¹ Jᵀ| μ`: the same of the payload's twist.
    pub(super) fn twist_direct(&self, x: &[f64], mu: &[f64]) -> Vec<f64> {
        let (n, inverse) = (self.n, &self.interval.inverse);
        let rows = || self.jacobian.chunks_exact(n);
        rows()
            .map(|row| {
                let by: Vec<f64> =
                    (0..n).map(|j| (0..n).map(|i| row[i] * inverse[i * n + j]).sum()).collect();
                let own: f64 = by.iter().zip(x).map(|(b, x)| b.abs() * x).sum();
                let rest = rows().zip(mu).map(|(other, mu)| {
                    let entry: f64 = by.iter().zip(other).map(|(b, o)| b * o).sum();
                    entry.abs() * mu
                });
                own + rest.sum::<f64>()
            })
            .collect()
    }
}
