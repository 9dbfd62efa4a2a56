//! What a sample would teach, before it counts.

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
}

impl<R: Real> Estimate<R> {
    /// Whether it can be stored and `demand`, of which `φ̂` is a part, be asked for. All that is remembered is in
    /// the sum: the observer's `φ̂_0`, and the literal form's integrals with their rests, through `φ̂`.
    pub(crate) fn fits(&self, demand: R) -> bool {
        let [_, first, second, third] = self.memory;
        (demand + (first + second + third)).is_finite()
    }
}
