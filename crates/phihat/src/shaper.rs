//! The reference governor: any reference in, one out that the arm can follow.

use crate::{Gain, GainError, Real, Reference};

/// Largest velocity, acceleration and jerk of a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimits {
    /// Largest |q̇_d| \[rad/s\].
    pub velocity: f64,
    /// Largest |q̈_d| \[rad/s²\].
    pub acceleration: f64,
    /// Largest |q⃛_d| \[rad/s³\].
    pub jerk: f64,
}

impl MotionLimits {
    /// Limits under which moving an inertia \[kg·m²\] takes at most `share` of a torque \[N·m\] and of a torque
    /// rate \[N·m/s\]; what is left is for gravity, friction and feedback.
    #[must_use]
    pub fn within_torque(
        velocity: f64,
        torque: f64,
        torque_rate: f64,
        inertia: f64,
        share: f64,
    ) -> Self {
        Self {
            velocity,
            acceleration: share * torque / inertia,
            jerk: share * torque_rate / inertia,
        }
    }
}

/// Makes a reference twice continuously differentiable and keeps it within [`MotionLimits`].
///
/// # Law
///
/// Each sample has constant jerk: `a' = a + jT`, `v' = v + (a + a')T/2`, `q' = q + vT + (2a + a')T²/6`. A
/// reference that keeps the limits by itself passes bit for bit. Otherwise, with `d` the distance to where
/// the reference is,
///
/// ```text
/// v* = q̇_d + w(d),   w = √(c² + 2Bd) − c,   c = max(B²/J, 20 B T)      speed from which d suffices to brake
/// a* = q̈_d − s B w/(w + c) + k (v* − v),    k = 4 B/c                   then |a' − a| ≤ JT, |a'| ≤ A,
/// a'²/2J + a'T/2 + v' ≤ V                                               so that |v| never passes V
/// ```
///
/// `B = 0.8 A`; `s = (v − q̇_d)/w` within 0 … 1: as much of the braking as the motion is fast. `d` and `v`
/// are taken where they are once the acceleration relative to the target has gone. These limits hold for
/// every reference, to rounding. Close to the target the loop is linear and stable.
///
/// ```
/// use phihat::{MotionLimits, Reference, Shaper};
/// let limits = MotionLimits { velocity: 1.0, acceleration: 5.0, jerk: 100.0 };
/// let shaper = Shaper::<f64>::new(&limits, 1e-3)?;
/// let target = Reference { q: 0.5, dq: 0.0, ddq: 0.0 };
/// let mut at = Reference::default();
/// for _ in 0..1500 { at = shaper.step(&at, &target); }
/// assert!((at.q - 0.5).abs() < 1e-9);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shaper<R> {
    period: R,
    velocity: R,
    acceleration: R,
    /// Acceleration used to brake onto the target; the rest is for the target's own motion.
    braking: R,
    jerk: R,
    /// Largest change of acceleration in a sample.
    step: R,
    /// `c`.
    soft: R,
    /// `k`.
    pull: R,
}

impl<R: Real> Shaper<R> {
    /// Limits at a sample period \[s\].
    ///
    /// # Errors
    ///
    /// [`GainError::NotPositive`] when a limit or the period is not positive and finite.
    pub fn new(limits: &MotionLimits, period: f64) -> Result<Self, GainError> {
        Gain::Period.positive(period)?;
        Gain::VelocityMax.positive(limits.velocity)?;
        Gain::AccelerationMax.positive(limits.acceleration)?;
        Gain::JerkMax.positive(limits.jerk)?;
        Ok(Self::of(limits, period))
    }

    /// [`Self::new`] of limits that are known to be positive.
    pub(crate) fn of(limits: &MotionLimits, period: f64) -> Self {
        let braking = 0.8 * limits.acceleration;
        let soft = (braking * braking / limits.jerk).max(20.0 * braking * period);
        Self {
            period: R::from_f64(period),
            velocity: R::from_f64(limits.velocity),
            acceleration: R::from_f64(limits.acceleration),
            braking: R::from_f64(braking),
            jerk: R::from_f64(limits.jerk),
            step: R::from_f64(limits.jerk * period),
            soft: R::from_f64(soft),
            // Four times the slope of w(d) at 0, which is braking/soft.
            pull: R::from_f64(4.0 * braking / soft),
        }
    }

    /// One sample from where the shaped reference is towards where it should be. A target that is not finite, or
    /// beyond ±2³², asks for a stop.
    #[must_use]
    pub fn step(&self, now: &Reference<R>, target: &Reference<R>) -> Reference<R> {
        if self.keeps(now, target) {
            return *target;
        }
        let stop = Reference::at_rest(now.q);
        let target = if target.doubt() == R::ZERO { target } else { &stop };
        let half = R::from_f64(0.5);
        let t = self.period;
        // Where the motion is once the acceleration relative to the target has gone.
        let relative = now.ddq - target.ddq;
        let fade = relative.abs() / self.jerk;
        let ahead = (now.dq - target.dq) + half * relative * fade;
        let travelled = fade * ((now.dq - target.dq) + relative * fade * R::from_f64(1.0 / 3.0));
        let distance = target.q - now.q - travelled;
        let size = distance.abs();
        let speed =
            (self.soft * self.soft + R::from_f64(2.0) * self.braking * size).sqrt() - self.soft;
        let (speed, brake) = if distance < R::ZERO {
            (-speed, self.braking * speed / (speed + self.soft))
        } else {
            (speed, -(self.braking * speed / (speed + self.soft)))
        };
        // Braking is due only as far as the motion is as fast as the braking curve.
        let due = if (ahead > R::ZERO) == (speed > R::ZERO) && ahead.abs() >= speed.abs() {
            brake
        } else if speed.abs() > R::TINY {
            let ratio = ahead / speed;
            if ratio > R::ZERO { brake * ratio } else { R::ZERO }
        } else {
            R::ZERO
        };
        let wanted = target.ddq + due + self.pull * (speed - ahead);
        self.advance(now, wanted, t)
    }

    /// Constant jerk towards an acceleration, within the limits.
    pub(crate) fn advance(&self, now: &Reference<R>, wanted: R, t: R) -> Reference<R> {
        let half = R::from_f64(0.5);
        let change = (wanted.saturate(self.acceleration) - now.ddq).saturate(self.step);
        let mut ddq = now.ddq + change;
        let middle = now.dq + half * now.ddq * t;
        let ceiling = self.fastest(self.velocity - middle);
        let floor = -self.fastest(self.velocity + middle);
        if ddq > ceiling {
            ddq = ceiling;
        } else if ddq < floor {
            ddq = floor;
        }
        // The velocity bound gives way to the jerk bound, which by induction it never needs to.
        ddq = now.ddq + (ddq - now.ddq).saturate(self.step);
        Reference { ddq: ddq.snap(), ..moved(now, ddq, t) }
    }

    /// Largest `a'` with `a'²/2J + a'T ≤ room`: the acceleration that can still be taken back before the
    /// velocity limit. Negative room asks for a negative one.
    fn fastest(&self, room: R) -> R {
        let step = self.step;
        let square = step * step + R::from_f64(2.0) * self.jerk * room;
        if square > R::ZERO { square.sqrt() - step } else { -step }
    }

    /// Returns true if the step from `now` to `target` is within all limits, and is a motion.
    fn keeps(&self, now: &Reference<R>, target: &Reference<R>) -> bool {
        let half = R::from_f64(0.5);
        let t = self.period;
        let within = |value: R, limit: R| value <= limit && value >= -limit;
        let speed = target.dq - now.dq;
        let travel = target.q - now.q;
        // What is left below the velocity limit, in the direction of the acceleration.
        let outward = if target.ddq < R::ZERO { -target.dq } else { target.dq };
        let reserve = target.ddq.abs() * (target.ddq.abs() + self.step);
        reserve <= R::from_f64(2.0) * self.jerk * (self.velocity - outward)
            && within(target.dq, self.velocity)
            && within(target.ddq, self.acceleration)
            && within(target.ddq - now.ddq, self.step)
            && within(speed, self.acceleration * t)
            && within(travel, self.velocity * t)
            && within(speed - half * t * (target.ddq + now.ddq), half * self.step * t)
            && within(travel - half * t * (target.dq + now.dq), self.step * t * t)
    }
}

/// The position, velocity and acceleration after a sample of constant jerk that ends at an acceleration.
pub(crate) fn moved<R: Real>(now: &Reference<R>, ddq: R, t: R) -> Reference<R> {
    let (half, sixth) = (R::from_f64(0.5), R::from_f64(1.0 / 6.0));
    Reference {
        q: now.q + t * now.dq + t * t * sixth * (R::from_f64(2.0) * now.ddq + ddq),
        dq: now.dq + half * t * (now.ddq + ddq),
        ddq,
    }
}
