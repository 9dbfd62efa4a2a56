//! What a sample would teach, before it counts.

use crate::innovation::Filtered;
use crate::{ORDER_MAX, Real};

/// What the estimator would remember after a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Estimate<R> {
    pub(crate) memory: [R; ORDER_MAX],
    /// Literal: what rounding left out of the sums. From positions: `ê`, `ė̂`, the feed-forward, and how many periods
    /// the interval had.
    pub(crate) beside: [R; ORDER_MAX],
    pub(crate) phi_hat: R,
    /// From positions: the torque asked for beside `φ̂`.
    pub(crate) outer: R,
    /// From positions: what has become of the innovations beside the observer; `None`: what it was.
    pub(crate) filtered: Option<Filtered<R>>,
}

impl<R: Real> Estimate<R> {
    /// Of a law without an innovation filter.
    pub(crate) fn of(memory: [R; ORDER_MAX], beside: [R; ORDER_MAX], phi_hat: R, outer: R) -> Self {
        Self { memory, beside, phi_hat, outer, filtered: None }
    }

    /// Whether it can be stored and `demand`, of which `φ̂` is a part, be asked for. All that is remembered is in
    /// the sum: the observer's `φ̂_0`, and the literal form's integrals with their rests, through `φ̂`.
    pub(crate) fn fits(&self, demand: R) -> bool {
        let [_, first, second, third] = self.memory;
        (demand + (first + second + third)).is_finite()
    }
}
