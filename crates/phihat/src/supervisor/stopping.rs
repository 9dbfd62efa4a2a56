//! Rules and state of a safe stop of one joint.

use crate::{JointGains, MotionLimits, Real, Reference, Shaper};

/// Share of the torque limit, and of the rate limit, that the deceleration of the nominal inertia takes: the
/// rest is for gravity, for an inertia twice the nominal one, and for feedback.
const TORQUE_SHARE: f64 = 0.25;

/// Error of the outer loop that the default deceleration corresponds to where no torque limit is stated \[rad\].
const STOPPING_ERROR: f64 = 0.2;

/// Largest speed that a stop may begin at for its profile to be exact \[rad/s\]; beyond it the profile brakes
/// all the same.
const FASTEST: f64 = 1e4;

/// Speed of the nominal inertia whose kinetic energy a stopped drive may give back at most \[rad/s\].
pub(crate) const RESERVE_SPEED: f64 = 0.2;

/// Time in which a rate limit takes back the feedback of a joint at rest \[s\].
const SMALL_S: f64 = 0.01;

/// Samples over which a joint has to stand for it to rest, and the speed that it may have in them on average
/// \[rad/s\]: the noise of an encoder drains the reserve of a joint that is held.
pub(crate) const REST_SAMPLES: u32 = 64;
const REST_SPEED: f64 = 0.02;

/// Profile and energy reserve of a safe stop of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StopRules<R> {
    pub(crate) profile: Shaper<R>,
    /// The profile is as stated, whatever the gains.
    stated: bool,
    /// Distance in which the profile stops, per velocity: `v/2A + A/2J`.
    stopping: [R; 2],
    /// `½ M̄ v²` \[J\].
    pub(crate) reserve: R,
    /// Largest motion of a joint at rest, within [`REST_SAMPLES`] \[rad\].
    pub(crate) rest_travel: R,
    /// `2 ρ M̄/4`; infinite without a rate limit.
    unloading: R,
    /// `ρ · 10 ms` \[N·m\].
    small: R,
}

/// State of a safe stop of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Stopping<R> {
    /// The law is under way from a measured state to rest.
    pub(crate) begun: bool,
    /// Energy that the drive may give beyond what it took \[J\].
    pub(crate) reserve: R,
    /// Samples in which the reserve held the torque back, since the stop began anew.
    pub(crate) held_back: u32,
    /// Number of times that the stop began anew for that reason.
    pub(crate) anew: u32,
    /// True if the holding torque may be estimated again from the start of the stop: nothing pushes the joint
    /// that would be taken for gravity, or the estimate had wound up. Else a second later.
    pub(crate) learns: bool,
    /// Position of rest \[rad\], and number of samples near it.
    pub(crate) rest: (R, u32),
    /// Speed beyond which the stop is one that drives \[rad/s\], and samples in a row beyond it.
    pub(crate) fastest: R,
    pub(crate) faster: u32,
    /// The largest speed since then \[rad/s\].
    pub(crate) peak: R,
    /// Samples since the drive did not follow its command and lost its torque; 0: it follows.
    pub(crate) let_go: u32,
    /// Number of times that it was let go and taken back, 255 at most.
    pub(crate) taken_back: u8,
}

impl<R: Real> StopRules<R> {
    /// Deceleration and jerk as stated, which are checked, or what gains and limits allow.
    pub(crate) fn new(gains: &JointGains<R>, stated: Option<&MotionLimits>) -> Self {
        let period = gains.period.to_f64();
        let limits = stated.copied().unwrap_or_else(|| allowed(gains, period));
        let limits = MotionLimits { velocity: FASTEST, ..limits };
        let MotionLimits { acceleration, jerk, .. } = limits;
        let half = R::from_f64(0.5);
        let speed = R::from_f64(RESERVE_SPEED);
        Self {
            profile: Shaper::of(&limits, period),
            stated: stated.is_some(),
            stopping: [0.5 / acceleration, 0.5 * acceleration / jerk].map(R::from_f64),
            reserve: half * gains.inertia * speed * speed,
            rest_travel: R::from_f64(REST_SPEED * f64::from(REST_SAMPLES) * period),
            small: R::from_f64(SMALL_S) * (gains.limits.step() / gains.period),
            unloading: half * gains.inertia * (gains.limits.step() / gains.period),
        }
    }

    /// The same stop of other gains: what they and their limits allow, unless it was stated.
    pub(crate) fn with_gains(self, gains: &JointGains<R>) -> Self {
        let other = Self::new(gains, None);
        if self.stated {
            let Self { profile, stopping, .. } = self;
            Self { profile, stopping, stated: true, ..other }
        } else {
            other
        }
    }

    /// Largest torque of the feedback at a velocity \[N·m\]: one that the rate limit `ρ` can take back before
    /// a joint of a quarter of the nominal inertia has turned round, and what it takes back in 10 ms.
    ///
    /// ```text
    /// √(2 ρ M̄/4 |q̇|) + ρ · 10 ms                                                                  as (Q2)
    /// ```
    pub(crate) fn unloaded_at(&self, velocity: R) -> R {
        if self.unloading.is_finite() {
            (self.unloading * velocity.abs()).sqrt() + self.small
        } else {
            self.unloading
        }
    }

    /// Position at which a joint with this motion comes to rest, a little beyond that of the profile \[rad\].
    pub(crate) fn rest_from(&self, at: &Reference<R>) -> R {
        let [square, linear] = self.stopping;
        at.q + at.dq * (square * at.dq.abs() + linear)
    }
}

impl<R: Real> JointGains<R> {
    /// The deceleration and jerk of a safe stop \[rad/s², rad/s³\] where
    /// [`JointOptions::stop`](crate::JointOptions::stop) states none: a quarter of what the torque and rate
    /// limits give the nominal inertia, or, without limits, what `K_p` gives at an error of 0.2 rad. It comes
    /// to rest from a speed `v` after `v²/2A + vA/2J`.
    pub fn stop_limits(&self) -> MotionLimits {
        allowed(self, self.period.to_f64())
    }

    /// Energy that the drive may give the joint beyond what it took in a safe stop, `½ M̄ (0.2 rad/s)²` \[J\].
    pub fn stop_reserve(&self) -> f64 {
        0.5 * self.inertia.to_f64() * RESERVE_SPEED * RESERVE_SPEED
    }
}

/// The deceleration that torque limits allow, or the outer loop where there are none.
fn allowed<R: Real>(gains: &JointGains<R>, period: f64) -> MotionLimits {
    let [inertia, kp, kd, torque, step] =
        [gains.inertia, gains.kp, gains.kd, gains.limits.torque(), gains.limits.step()]
            .map(Real::to_f64);
    let within = TORQUE_SHARE * torque / inertia;
    let acceleration = if within.is_finite() { within } else { STOPPING_ERROR * kp };
    let within = TORQUE_SHARE * step / (inertia * period);
    let smooth = 0.5 * acceleration * kd;
    MotionLimits {
        velocity: FASTEST,
        acceleration,
        jerk: if within < smooth { within } else { smooth },
    }
}
