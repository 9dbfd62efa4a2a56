//! The reference governor with an end to the way: any reference in, one out that never leaves a box.

use crate::shaper::moved;
use crate::{Gain, GainError, MotionLimits, Real, Reference, Shaper};

/// Parts of a braking motion: to the braking acceleration, at it, back to none; and before them, where it has the
/// wrong sign, to none.
const PARTS: usize = 4;

/// Share per sample of what a motion is off a target that is within the limits by which it comes onto it.
const FOLLOWED: f64 = 0.05;

/// Share of the largest jerk by which a braking motion is planned: the rest is for rounding.
const SURE_SHARE: f64 = 1.0 - 1e-6;

/// Rest of a braking motion of a [`BoxedShaper`]: samples of each part, and the change of acceleration in each of them
/// \[rad/s²\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Braking<R> {
    parts: [(u32, R); PARTS],
}

impl<R: Real> Braking<R> {
    /// Returns true if nothing of it is left.
    pub fn is_over(&self) -> bool {
        self.parts.iter().all(|(samples, _)| *samples == 0)
    }
}

/// Keeps any reference within [`MotionLimits`] and a box of positions: a motion of constant jerk in each sample, at all
/// times with `|q̇| ≤ V`, `|q̈| ≤ A`, `|q⃛| ≤ J` and `q` in the box, whatever is requested.
///
/// # Law
///
/// Each sample takes the step of a [`Shaper`], integrated by its own acceleration, if the arm can be braked to rest
/// inside the box after it; else the next sample of the braking motion that was possible before. Braking from `q`,
/// `v`, `a`, with `v` not negative and `b = min(A, √(JV))`, is a line of acceleration to `a₁`, `a₁` for a time, and a
/// line to 0, over whole samples `n₁, n₂, n₃`:
///
/// ```text
/// a₁ = −(v/T + a n₁/2) / (n₁/2 + n₂ + n₃/2),   n₁ = ⌈|a + b|/JT⌉,  n₃ = ⌈b/JT⌉,  n₂ ≥ 0 the least with |a₁| ≤ b
/// ```
///
/// where that is within the limits; else the acceleration goes to 0 first, and then the same from there.
///
/// The box holds by induction: the motion starts at rest in it, and after each sample a braking motion is known whose
/// every sample is inside. docs/theory/class.md states it as a lemma.
///
/// # Errors and rounding
///
/// Limits hold to rounding of the scalar. A start outside of the box is held where it is.
///
/// ```
/// use phihat::{BoxedShaper, Braking, MotionLimits, Reference};
/// let limits = MotionLimits { velocity: 1.0, acceleration: 5.0, jerk: 100.0 };
/// let shaper = BoxedShaper::<f64>::new(&limits, (-0.5, 0.5), 1e-3)?;
/// let (mut at, mut braking) = (Reference::default(), Braking::default());
/// for _ in 0..3000 {
///     // Nobody could follow that.
///     at = shaper.step(&at, &Reference { q: 7.0, dq: 100.0, ddq: 0.0 }, &mut braking);
///     assert!(at.q <= 0.5 + 1e-12);
/// }
/// assert!(at.q > 0.45);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxedShaper<R> {
    shaper: Shaper<R>,
    lower: R,
    upper: R,
    period: R,
    velocity: R,
    /// Largest acceleration of braking, `b`.
    braking: R,
    /// Largest change of acceleration in a sample, `JT`.
    step: R,
    /// That, less what rounding may take.
    sure: R,
    /// `⌈b/JT⌉`.
    ramp: R,
    /// Rate at which it comes onto a target that is within the limits \[1/s\].
    rate: R,
    /// No braking motion is longer \[rad\].
    reach: R,
}

impl<R: Real> BoxedShaper<R> {
    /// Limits, ends of the box \[rad\] and sample period \[s\].
    ///
    /// # Errors
    ///
    /// [`GainError::NotPositive`] when a limit, the period or the width of the box is not positive and finite.
    pub fn new(
        limits: &MotionLimits,
        (lower, upper): (f64, f64),
        period: f64,
    ) -> Result<Self, GainError> {
        let shaper = Shaper::new(limits, period)?;
        let MotionLimits { velocity, acceleration, jerk } = *limits;
        // Where a motion turns within a sample, it is this much farther there than at either end.
        let between = 0.125 * acceleration * period * period;
        let (lower, upper) = (lower + between, upper - between);
        Gain::BoxWidth.positive(upper - lower)?;
        let step = jerk * period;
        let root = Real::sqrt(jerk * velocity);
        let braking = if acceleration < root { acceleration } else { root };
        let ramp = f64::from(whole(braking / (SURE_SHARE * step)));
        // To no acceleration at full speed, of which there is at most 2√(JV); then braking from that speed.
        let release = 2.0 * Real::sqrt(velocity / jerk) + period;
        let stop = velocity / braking + (ramp + 2.0) * period;
        let reach = velocity * (release + 0.5 * (ramp * period + stop));
        Ok(Self {
            shaper,
            lower: R::from_f64(lower),
            upper: R::from_f64(upper),
            period: R::from_f64(period),
            velocity: R::from_f64(velocity),
            braking: R::from_f64(braking),
            step: R::from_f64(step),
            sure: R::from_f64(SURE_SHARE * step),
            ramp: R::from_f64(ramp),
            rate: R::from_f64(FOLLOWED / period),
            reach: R::from_f64(1.01 * reach),
        })
    }

    /// Returns true if a position is in the box.
    pub fn contains(&self, q: R) -> bool {
        q >= self.lower && q <= self.upper
    }

    /// One sample from where the reference is towards where it should be; `braking` is kept from sample to sample, and
    /// is the default at a start at rest.
    #[must_use]
    pub fn step(
        &self,
        now: &Reference<R>,
        target: &Reference<R>,
        braking: &mut Braking<R>,
    ) -> Reference<R> {
        let shaped = self.shaper.step(now, target);
        let wanted = if shaped == *target { self.towards(now, target) } else { shaped.ddq };
        let next = self.shaper.advance(now, wanted, self.period);
        let room = next.q - self.reach > self.lower && next.q + self.reach < self.upper;
        if room || self.braking_from(&next).is_some() {
            *braking = Braking::default();
            return next;
        }
        if braking.is_over() {
            *braking = self.braking_from(now).unwrap_or_default();
        }
        self.braked(now, braking)
    }

    /// The acceleration of a target that a [`Shaper`] takes as it is, and what brings the motion onto it: every sample
    /// is integrated, so that a target may be off by what rounding, or a caller, makes of it.
    fn towards(&self, now: &Reference<R>, target: &Reference<R>) -> R {
        let on = moved(now, target.ddq, self.period);
        let (rate, two) = (self.rate, R::from_f64(2.0));
        target.ddq + rate * (two * (target.dq - on.dq) + rate * (target.q - on.q))
    }

    /// The next sample of a braking motion; at rest after its last.
    fn braked(&self, now: &Reference<R>, braking: &mut Braking<R>) -> Reference<R> {
        let part = braking.parts.iter_mut().find(|(samples, _)| *samples > 0);
        let Some((samples, change)) = part else { return Reference::at_rest(now.q) };
        *samples -= 1;
        let next = moved(now, now.ddq + *change, self.period);
        if braking.is_over() { Reference::at_rest(next.q) } else { next }
    }

    /// A braking motion that stays in the box and within the limits; `None`: neither of the two does.
    fn braking_from(&self, at: &Reference<R>) -> Option<Braking<R>> {
        let inside = |q: R| self.contains(q);
        if at.dq == R::ZERO && at.ddq == R::ZERO {
            return inside(at.q).then(Braking::default);
        }
        if let Some((braking, rest)) = self.direct(at) {
            if inside(rest) {
                return Some(braking);
            }
        }
        // To no acceleration first.
        let count = whole((at.ddq.abs() / self.sure).to_f64());
        let samples = R::from_f64(f64::from(count));
        let time = samples * self.period;
        let still = Reference {
            q: at.q + time * (at.dq + R::from_f64(1.0 / 3.0) * at.ddq * time),
            dq: at.dq + R::from_f64(0.5) * at.ddq * time,
            ddq: R::ZERO,
        };
        // Where it turns on the way, it was not farther than this.
        let turns = at.dq * still.dq < R::ZERO && !inside(at.q + time * at.dq);
        let (mut braking, rest) = self.direct(&still)?;
        if turns || !inside(rest) {
            return None;
        }
        if count > 0 {
            let [_, first, second, third] = braking.parts;
            let change = R::ZERO - at.ddq / samples;
            braking = Braking { parts: [(count, change), first, second, third] };
        }
        Some(braking)
    }

    /// Braking without a way around, and where it ends; `None`: it would leave the limits, or turn.
    fn direct(&self, at: &Reference<R>) -> Option<(Braking<R>, R)> {
        let half = R::from_f64(0.5);
        let (sign, v) =
            if at.dq < R::ZERO { (-R::from_f64(1.0), -at.dq) } else { (R::from_f64(1.0), at.dq) };
        let a = sign * at.ddq;
        let first = whole(((a + self.braking).abs() / self.sure).to_f64());
        let (n1, n3, t) = (R::from_f64(f64::from(first)), self.ramp, self.period);
        let change = v / t + half * n1 * a;
        if change < R::ZERO {
            return None;
        }
        // Samples at the braking acceleration.
        let ends = half * (n1 + n3);
        let hold = whole((change / self.braking - ends).to_f64());
        let n2 = R::from_f64(f64::from(hold));
        let a1 = R::ZERO - change / (ends + n2);
        let most = n1 * self.step;
        if a1 - a > most || a - a1 > most {
            return None;
        }
        let per_sample = if first > 0 { (a1 - a) / n1 } else { R::ZERO };
        // Where it still gets faster, with less than the largest jerk.
        if a > R::ZERO && v + half * a * a * t / -per_sample > self.velocity {
            return None;
        }
        let (t1, t2, t3) = (n1 * t, n2 * t, n3 * t);
        let third = R::from_f64(1.0 / 3.0);
        let v1 = v + half * (a + a1) * t1;
        let v2 = v1 + a1 * t2;
        let way = t1 * (v + third * (a + half * a1) * t1)
            + t2 * (v1 + half * a1 * t2)
            + t3 * (v2 + third * a1 * t3);
        let last = whole(n3.to_f64());
        let parts = [
            (0, R::ZERO),
            (first, sign * per_sample),
            (hold, R::ZERO),
            (last, R::ZERO - sign * a1 / n3),
        ];
        Some((Braking { parts }, at.q + sign * way))
    }
}

/// The least whole number that is not smaller, from 0 on.
fn whole(x: f64) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the cast of a float saturates; what is larger means the same: a very long time"
    )]
    let below = x as u32;
    if f64::from(below) < x { below.saturating_add(1) } else { below }
}
