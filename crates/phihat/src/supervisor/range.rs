//! Soft joint limits: brake in time, never push outward at the stop.

use crate::{JointGains, Real};

/// Share of the soft zone that a reference keeps off the hard limit: what an overshoot may use up.
const REFERENCE_SHARE: f64 = 0.25;

/// Share of the braking that the quick look counts on: a hundredth is left for its rounding.
const SURE_SHARE: f64 = 0.99;

/// Position limits of one joint, hard and soft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointRange {
    /// Lower hard limit \[rad\].
    pub lower: f64,
    /// Upper hard limit \[rad\]; beyond either the arm stops.
    pub upper: f64,
    /// Width of the soft zone inside of each \[rad\]: there the estimate does not grow outward. The
    /// reference is kept a quarter of it away from the hard limit.
    pub soft: f64,
    /// Deceleration that the joint can always afford \[rad/s²\]: outward velocity is kept below
    /// `√(2 b · room)`.
    pub braking: f64,
}

/// [`JointRange`] in the running scalar, with the gains in front of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RangeRules<R> {
    /// Hard limits.
    lower: R,
    upper: R,
    /// Inner ends of the soft zones \[rad\].
    soft_lower: R,
    soft_upper: R,
    /// Limits of a reference \[rad\].
    reference_lower: R,
    reference_upper: R,
    soft: R,
    braking: R,
    inertia: R,
    inertia_inverse: R,
    kd: R,
    /// Time to shed one N·m, 0 without a rate limit.
    shed: R,
    /// Torque that brakes, `M̄ b`.
    brake: R,
    /// A hundredth less than `braking`: what [`Self::is_easy`] leaves for rounding.
    braking_for_sure: R,
}

impl<R: Real> RangeRules<R> {
    pub(crate) fn new(range: &JointRange, gains: &JointGains<R>) -> Self {
        let [lower, upper, soft] = [range.lower, range.upper, range.soft].map(R::from_f64);
        let quarter = R::from_f64(REFERENCE_SHARE * range.soft);
        let (zero, braking) = (R::ZERO, R::from_f64(range.braking));
        let plain = Self {
            lower,
            upper,
            soft_lower: lower + soft,
            soft_upper: upper - soft,
            reference_lower: lower + quarter,
            reference_upper: upper - quarter,
            soft,
            braking,
            inertia: zero,
            kd: zero,
            shed: zero,
            inertia_inverse: zero,
            brake: zero,
            braking_for_sure: R::from_f64(SURE_SHARE) * braking,
        };
        plain.with_gains(gains)
    }

    /// The same range in front of other gains.
    pub(crate) fn with_gains(self, gains: &JointGains<R>) -> Self {
        Self {
            inertia: gains.inertia,
            inertia_inverse: gains.inertia_inverse,
            kd: gains.kd,
            shed: gains.period / gains.limits.step(),
            brake: gains.inertia * self.braking,
            ..self
        }
    }

    /// Returns true if a position is beyond a hard limit.
    pub(crate) fn left(&self, q: R) -> bool {
        q > self.upper || q < self.lower
    }

    /// Reference position moved away from a hard limit \[rad\]; `None`: it is far enough from both.
    pub(crate) fn keep(&self, q: R) -> Option<R> {
        if q > self.reference_upper {
            Some(self.reference_upper)
        } else if q < self.reference_lower {
            Some(self.reference_lower)
        } else {
            None
        }
    }

    /// An estimate that does not grow outward inside a soft zone. `before`: what it may be at most, or at least.
    pub(crate) fn freeze(&self, q: R, before: R, now: R) -> R {
        let outward =
            (q > self.soft_upper && now > before) || (q < self.soft_lower && now < before);
        if outward { before } else { now }
    }

    /// Torque demand reduced so that the joint can brake before its limit \[N·m\]; `None`: no reduction.
    /// `last`: the torque of the last sample.
    ///
    /// ```text
    /// upper side: τ ≤ φ̂ + M̄ (K_d (v − q̇) − b q̇/v),  v = √(2 b (q_max − q));  τ ≤ 0 at q_max
    /// ```
    ///
    /// `q` and `q̇` are taken where they are once the torque has come down to braking at its rate limit.
    #[inline]
    pub(crate) fn cap(&self, q: R, dq: R, phi_hat: R, demand: R, last: R) -> Option<R> {
        let (above, below) = (self.upper - q, q - self.lower);
        if self.is_easy(above, below, dq, last - phi_hat) {
            return None;
        }
        if let Some(ceiling) = self.ceiling(above, dq, phi_hat, last) {
            if demand > ceiling {
                return Some(ceiling);
            }
        }
        if let Some(ceiling) = self.ceiling(below, -dq, -phi_hat, -last) {
            if -demand > ceiling {
                return Some(-ceiling);
            }
        }
        None
    }

    /// Returns true if [`Self::ceiling`] is certainly `None` on both sides, by a bound that is faster to
    /// compute.
    fn is_easy(&self, above: R, below: R, dq: R, push: R) -> bool {
        let room = if above < below { above } else { below };
        let push = push.abs();
        let time = (push + self.brake) * self.shed;
        let speed = dq.abs() + time * (push * self.inertia_inverse);
        let left = room - time * speed;
        room >= self.soft && speed * speed <= self.braking_for_sure * left
    }

    /// Largest outward torque with `room` left, at an outward velocity.
    fn ceiling(&self, room: R, outward: R, phi_hat: R, last: R) -> Option<R> {
        // The acceleration that has to go first, and how long that takes.
        let push = last - phi_hat;
        let time = (push + self.brake) * self.shed;
        let (mut left, mut speed) = (room, outward);
        if time > R::ZERO {
            // From `now` to `−b` in a line.
            let now = push * self.inertia_inverse;
            let rest = now - self.braking;
            speed = outward + time * (R::from_f64(0.5) * rest);
            left = room - time * (outward + time * (R::from_f64(1.0 / 6.0) * (now + rest)));
        }
        let near = room < self.soft || (speed > R::ZERO && speed * speed > self.braking * left);
        if !near {
            return None;
        }
        let allowed = (R::from_f64(2.0) * self.braking * left).sqrt();
        let mut deceleration = self.braking;
        if speed < allowed {
            deceleration = if speed > R::ZERO { self.braking * (speed / allowed) } else { R::ZERO };
        }
        let ceiling = phi_hat + self.inertia * (self.kd * (allowed - speed) - deceleration);
        Some(if room > R::ZERO || ceiling < R::ZERO { ceiling } else { R::ZERO })
    }
}
