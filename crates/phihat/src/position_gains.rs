//! Gains of a law from positions, and the joint's motion in its model.

use crate::delay::PENDING_MAX;
use crate::innovation::InnovationFilter;
use crate::{ORDER_MAX, Real};

/// Factors of `ê`, `ė̂`, `φ̂` and its derivatives: of an innovation, or of the wanted torque.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Correction<R> {
    pub(crate) e: R,
    pub(crate) de: R,
    /// In \[N·m/s^j\] per \[rad\] or \[rad/s\].
    pub(crate) phi: [R; 3],
}

/// Gains of this form only.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct PositionGains<R> {
    pub(crate) on_position: Correction<R>,
    pub(crate) on_velocity: Correction<R>,
    /// One period.
    pub(crate) step: Step<R>,
    /// Weights of `ê`, `ė̂`, `φ̂` … in the wanted torque, with the prediction through the delay.
    pub(crate) seen: Correction<R>,
    /// Weights of the torques on their way in it, the newest first.
    pub(crate) coming: [R; PENDING_MAX],
    /// `g`: share of the way to the wanted torque per sample.
    pub(crate) share: R,
    pub(crate) delay: u8,
    /// True if a measured velocity corrects the observer.
    pub(crate) hears_velocity: bool,
    /// Filter on the innovation.
    pub(crate) filter: InnovationFilter<R>,
}

/// State of the observer at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expected<R> {
    pub(crate) e: R,
    pub(crate) de: R,
    pub(crate) phi: [R; 3],
}

/// Coefficients of a joint's motion over a time: `t`, `t/M̄` and `t²/(2 M̄)`.
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
    /// State after a step under a torque \[N·m\], less its feed-forward: exact where `φ` and the torque are
    /// equal to their means over the step. `φ̂` is that mean.
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

/// Weighted sum of the torques on their way \[N·m\].
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
