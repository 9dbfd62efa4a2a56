//! Soft joint limits: brake in time, never push outward at the stop.

use crate::Real;

/// Where a joint may be.
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

/// [`JointRange`] in the running scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RangeRules<R> {
    pub(crate) lower: R,
    pub(crate) upper: R,
    soft: R,
    braking: R,
    quarter: R,
}

impl<R: Real> RangeRules<R> {
    pub(crate) fn new(range: &JointRange) -> Self {
        Self {
            lower: R::from_f64(range.lower),
            upper: R::from_f64(range.upper),
            soft: R::from_f64(range.soft),
            braking: R::from_f64(range.braking),
            quarter: R::from_f64(0.25 * range.soft),
        }
    }

    /// Whether a position is beyond a hard limit.
    pub(crate) fn left(&self, q: R) -> bool {
        q > self.upper || q < self.lower
    }

    /// A reference position, kept off the hard limits; `true` when it was changed.
    pub(crate) fn keep(&self, q: R) -> (R, bool) {
        let (low, high) = (self.lower + self.quarter, self.upper - self.quarter);
        if q > high {
            (high, true)
        } else if q < low {
            (low, true)
        } else {
            (q, false)
        }
    }

    /// An estimate that does not grow outward inside a soft zone.
    pub(crate) fn freeze(&self, q: R, before: R, now: R) -> R {
        let outward = (now > before && q > self.upper - self.soft)
            || (now < before && q < self.lower + self.soft);
        if outward { before } else { now }
    }

    /// A torque demand, with outward velocity capped by the braking distance; `true` when it was changed.
    /// `law`: `φ̂`, `M̄`, `K_d`. `torque`: the demand, the last torque, and the time to shed one N·m of it.
    ///
    /// ```text
    /// upper side: τ ≤ φ̂ + M̄ (K_d (v − q̇) − b q̇/v),  v = √(2 b (q_max − q));  τ ≤ 0 at q_max
    /// ```
    ///
    /// `q` and `q̇` are taken where they are once the torque has come down to braking at its rate limit.
    pub(crate) fn cap(&self, q: R, dq: R, law: (R, R, R), torque: (R, R, R)) -> (R, bool) {
        let (phi_hat, inertia, kd) = law;
        let (demand, last, shed) = torque;
        let above = self.ceiling(self.upper - q, dq, law, (last, shed));
        if let Some(ceiling) = above
            && demand > ceiling
        {
            return (ceiling, true);
        }
        let law = (-phi_hat, inertia, kd);
        let below = self.ceiling(q - self.lower, -dq, law, (-last, shed));
        if let Some(ceiling) = below
            && -demand > ceiling
        {
            return (-ceiling, true);
        }
        (demand, false)
    }

    /// Largest outward torque with `room` left, at an outward velocity.
    fn ceiling(
        &self,
        room: R,
        outward: R,
        (phi_hat, inertia, kd): (R, R, R),
        (last, shed): (R, R),
    ) -> Option<R> {
        // Far from the end and not on the way there: nothing to reckon.
        let far = room > self.soft && outward <= R::ZERO && last <= phi_hat;
        if far {
            return None;
        }
        // The acceleration that has to go first, and how long that takes.
        let push = last - phi_hat;
        let time = (push + inertia * self.braking) * shed;
        let (mut left, mut speed) = (room, outward);
        if time > R::ZERO {
            let (now, drop) = (push / inertia, (push / inertia + self.braking) * time);
            let (half, third) = (R::from_f64(0.5), R::from_f64(1.0 / 3.0));
            speed = outward + time * (now - half * drop);
            left = room - time * (outward + half * time * (now - third * drop));
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
        let ceiling = phi_hat + inertia * (kd * (allowed - speed) - deceleration);
        Some(if room > R::ZERO || ceiling < R::ZERO { ceiling } else { R::ZERO })
    }
}
