//! Estimate after a sample, before it is stored.

use crate::innovation::Filtered;
use crate::{ORDER_MAX, Real};

/// State of the estimator after a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Estimate<R> {
    pub(crate) memory: [R; ORDER_MAX],
    /// Literal: rounding errors of the sums. From positions: `ê`, `ė̂`, the feed-forward, and the number of
    /// periods in the interval.
    pub(crate) beside: [R; ORDER_MAX],
    pub(crate) phi_hat: R,
    /// From positions: the torque demand less `φ̂` \[N·m\].
    pub(crate) outer: R,
    /// From positions: state of the innovation filter; `None`: unchanged.
    pub(crate) filtered: Option<Filtered<R>>,
}

impl<R: Real> Estimate<R> {
    /// Of a law without an innovation filter.
    pub(crate) fn of(memory: [R; ORDER_MAX], beside: [R; ORDER_MAX], phi_hat: R, outer: R) -> Self {
        Self { memory, beside, phi_hat, outer, filtered: None }
    }

    /// Returns true if it can be stored and `demand`, which contains `φ̂`, can be commanded. All that is
    /// stored is in the sum: the observer's `φ̂_0`, and the literal form's integrals with their rests,
    /// through `φ̂`.
    pub(crate) fn fits(&self, demand: R) -> bool {
        let [_, first, second, third] = self.memory;
        (demand + (first + second + third)).is_finite()
    }
}
