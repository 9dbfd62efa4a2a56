//! What only a law from positions has: its numbers, and how a joint moves in its eyes.

use crate::delay::PENDING_MAX;
use crate::innovation::InnovationFilter;
use crate::{ORDER_MAX, Real};

/// What an innovation corrects: `ê`, `ė̂`, `φ̂` and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Correction<R> {
    pub(crate) e: R,
    pub(crate) de: R,
    /// In \[N·m/s^j\] per \[rad\] or \[rad/s\].
    pub(crate) phi: [R; 3],
}

/// What of the gains only this law has.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct PositionGains<R> {
    pub(crate) on_position: Correction<R>,
    pub(crate) on_velocity: Correction<R>,
    /// One period.
    pub(crate) step: Step<R>,
    /// What `ê`, `ė̂`, `φ̂` … weigh in the torque that is wanted, once they are carried on through the delay.
    pub(crate) seen: Correction<R>,
    /// What the torques on their way weigh in it, the newest first.
    pub(crate) coming: [R; PENDING_MAX],
    /// `g`: what share of the way to the torque that it wants the law goes in one sample.
    pub(crate) share: R,
    pub(crate) delay: u8,
    /// Whether a velocity corrects it.
    pub(crate) hears_velocity: bool,
    /// What becomes of the innovation beside the observer.
    pub(crate) filter: InnovationFilter<R>,
}

/// What the observer holds to be true at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expected<R> {
    pub(crate) e: R,
    pub(crate) de: R,
    pub(crate) phi: [R; 3],
}

/// What a time does to a joint: `t`, and `t` and `t²/2` over `M̄`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Step<R> {
    pub(crate) t: R,
    pub(crate) velocity: R,
    pub(crate) position: R,
}

impl<R: Real> Step<R> {
    pub(crate) fn new(t: f64, inertia: f64) -> Self {
        let n = |x: f64| R::from_f64(x);
        Self { t: n(t), velocity: n(t / inertia), position: n(0.5 * t * t / inertia) }
    }

    /// The same for `share` of the time.
    pub(crate) fn times(self, share: R) -> Self {
        Self {
            t: self.t * share,
            velocity: self.velocity * share,
            position: self.position * share * share,
        }
    }
}

impl<R: Real> Expected<R> {
    /// The joint after a step under a torque \[N·m\] beside its feed-forward: exact for a `φ` that holds, as the torque
    /// does, its mean over the step. `φ̂` is that mean.
    #[must_use]
    pub(crate) fn after(self, by: &Step<R>, torque: R) -> Self {
        let [phi, d1, d2] = self.phi;
        let push = torque - phi;
        Self {
            e: self.e + (by.t * self.de + by.position * push),
            de: self.de + by.velocity * push,
            phi: [phi + by.t * d1, d1 + by.t * d2, d2],
        }
    }

    pub(crate) fn correct(&mut self, by: &Correction<R>, innovation: R) {
        self.e += by.e * innovation;
        self.de += by.de * innovation;
        for (phi, gain) in self.phi.iter_mut().zip(&by.phi) {
            *phi += *gain * innovation;
        }
    }
}

impl<R: Real> PositionGains<R> {
    /// The largest factors on a sample.
    pub(crate) fn largest(&self) -> [R; ORDER_MAX] {
        let most = |by: &Correction<R>| {
            by.phi.iter().fold(by.e.abs() + by.de.abs(), |sum, factor| sum + factor.abs())
        };
        let coming = self.coming.iter().fold(R::ZERO, |sum, factor| sum + factor.abs());
        [
            most(&self.on_position),
            most(&self.on_velocity),
            most(&self.seen),
            coming + self.filter.largest(),
        ]
    }
}

/// Entry `at` of what the last samples left, the newest first, once `later` samples had passed without a new one.
pub(crate) fn entry<R: Real, const K: usize>(of: &[R; K], at: u8, later: u8) -> R {
    of.get(usize::from(at.saturating_sub(later))).copied().unwrap_or(R::ZERO)
}

/// What the torques on their way come to.
pub(crate) fn weighed<R: Real>(
    weights: &[R; PENDING_MAX],
    values: &[R; PENDING_MAX],
    delay: u8,
) -> R {
    let ([a, b, c, d], [p, q, r, s]) = (*weights, *values);
    let newest = a * p;
    if delay > 1 { newest + (b * q + (c * r + d * s)) } else { newest }
}

/// The newest goes in front.
pub(crate) fn push<R: Real, const K: usize>(into: &mut [R; K], newest: R) {
    let mut held = newest;
    for slot in into {
        held = core::mem::replace(slot, held);
    }
}
