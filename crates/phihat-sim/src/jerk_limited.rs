//! Jerk-limited motions towards positions that change at any instant: one of a class, drawn from a seed, and that to
//! the setpoints of a study.

use phihat::{BoxedShaper, Braking, GainError, MotionLimits, Reference, Shaper};
use phihat_study::MotionClass;

use crate::spline::Jet;
use crate::world::Draws;

/// Period of the motion's own steps, of constant jerk each \[s\].
const STEP: f64 = 1e-3;

/// Motion beyond the end of the run, for whoever looks ahead \[s\].
const BEYOND: f64 = 1.0;

/// Travel of a joint without ends, either way from its start \[rad\]; and what a time may be off by rounding \[s\].
const ENDLESS: f64 = 1e4;
const ROUNDING: f64 = 1e-9;

/// Share of the box's width that targets stay away from its ends, first, and how often it is doubled where a motion
/// leaves the box.
const INSET: f64 = 1e-3;
const DOUBLINGS: u32 = 9;

/// Shares of the speed limit, and of the others, that are used: a rounding below all of them.
const SHARE: f64 = 1.0 - 1e-9;

/// Motion of one joint in steps of constant jerk.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JerkLimitedMotion {
    jets: Vec<Jet>,
}

impl JerkLimitedMotion {
    /// Draws the motion of a joint, at rest at the centre of the class first.
    ///
    /// # Method
    ///
    /// A [`Shaper`] is given targets at rest: either end of the box, or any point inside, for times that are drawn too,
    /// often shorter than the way takes. Its acceleration is integrated step by step, so that speed, acceleration and
    /// jerk are within the class whatever the targets.
    pub(crate) fn draw(class: &MotionClass, joint: usize, seed: u64, duration: f64) -> Self {
        let mut inset = INSET;
        for _ in 0..DOUBLINGS {
            if let Some(own) = Self::within(class, (joint, seed), duration, inset) {
                return own;
            }
            inset *= 2.0;
        }
        Self { jets: vec![[class.center[joint], 0.0, 0.0]] }
    }

    /// The motion from rest at the first of some positions towards each, from its time on, within limits `|q̇_d|`,
    /// `|q̈_d|`, `|q⃛_d|` and the ends of the joint's travel.
    ///
    /// # Errors
    ///
    /// [`GainError`]: a limit is not positive, or the travel too short for any motion.
    pub(crate) fn towards(
        targets: impl Iterator<Item = (f64, f64)>,
        [velocity, acceleration, jerk]: [f64; 3],
        travel: Option<(f64, f64)>,
        duration: f64,
    ) -> Result<Self, GainError> {
        let mut targets = targets.peekable();
        let start = targets.peek().map_or(0.0, |(_, q)| *q);
        let ends = travel.unwrap_or((start - ENDLESS, start + ENDLESS));
        let limits = MotionLimits { velocity, acceleration, jerk };
        let shaper = BoxedShaper::<f64>::new(&limits, ends, STEP)?;
        let (mut now, mut target, mut braking) =
            (at_rest(start), at_rest(start), Braking::default());
        let mut jets = Vec::new();
        for step in 0..steps(duration) {
            // A setpoint acts from the first step on that is not before it.
            let t = step as f64 * STEP;
            while let Some((_, q)) = targets.next_if(|(from, _)| *from <= t + ROUNDING) {
                target = at_rest(q);
            }
            jets.push([now.q, now.dq, now.ddq]);
            now = shaper.step(&now, &target, &mut braking);
        }
        Ok(Self { jets })
    }

    /// `None`: it leaves the box.
    fn within(
        class: &MotionClass,
        (joint, seed): (usize, u64),
        duration: f64,
        inset: f64,
    ) -> Option<Self> {
        let limits = MotionLimits {
            velocity: SHARE * class.speed[joint],
            acceleration: SHARE * class.acceleration[joint],
            jerk: SHARE * class.jerk[joint],
        };
        let shaper = Shaper::<f64>::new(&limits, STEP).ok()?;
        let (low, high) = (class.low[joint], class.high[joint]);
        let margin = inset * (high - low);
        // The time in which a way across the box, or a change of speed, is done.
        let (v, a, j) = (limits.velocity, limits.acceleration, limits.jerk);
        let (across, turn) = ((high - low) / v, v / a + a / j);
        let draws = Draws::of(seed, joint);
        let mut draw = 0;
        let mut next = || {
            draw += 1;
            draws.uniform(draw)
        };
        let mut now = at_rest(class.center[joint]);
        let (mut target, mut left) = (now, 0.0);
        let mut jets = Vec::new();
        for _ in 0..steps(duration) {
            if left <= 0.0 {
                let place = next();
                let at = match place {
                    p if p < 0.4 => low + margin,
                    p if p < 0.8 => high - margin,
                    _ => low + margin + next() * (high - low - 2.0 * margin),
                };
                target = at_rest(at);
                let longest = if next() < 0.5 { turn } else { across + turn };
                left = (0.1 + 1.9 * next()) * longest;
            }
            if now.q < low || now.q > high {
                return None;
            }
            jets.push([now.q, now.dq, now.ddq]);
            let most = limits.jerk * STEP;
            let change = (shaper.step(&now, &target).ddq - now.ddq).clamp(-most, most);
            now = Reference {
                q: now.q + STEP * now.dq + STEP * STEP / 6.0 * (3.0 * now.ddq + change),
                dq: now.dq + STEP * (now.ddq + 0.5 * change),
                ddq: now.ddq + change,
            };
            left -= STEP;
        }
        Some(Self { jets })
    }

    /// `q_d`, `q̇_d`, `q̈_d` at a time \[s\].
    pub(crate) fn at(&self, t: f64) -> Jet {
        let last = self.jets.len() - 1;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let k = (t / STEP).floor().clamp(0.0, last as f64) as usize;
        let [q, dq, ddq] = self.jets[k];
        let Some([_, _, next]) = self.jets.get(k + 1) else { return [q, 0.0, 0.0] };
        let (s, jerk) = ((t - k as f64 * STEP).max(0.0), (next - ddq) / STEP);
        let half = 0.5 * s * s;
        [
            q + s * dq + half * ddq + half * s / 3.0 * jerk,
            dq + s * ddq + half * jerk,
            ddq + s * jerk,
        ]
    }
}

/// Steps of a motion of a run.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
fn steps(duration: f64) -> u64 {
    ((duration + BEYOND) / STEP).ceil().clamp(1.0, 1e9) as u64
}

fn at_rest(q: f64) -> Reference<f64> {
    Reference { q, dq: 0.0, ddq: 0.0 }
}
