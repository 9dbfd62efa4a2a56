//! What one joint's law takes, gives and remembers.

use crate::{ORDER_MAX, Real};

/// What the joint's sensors say at a sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measurement<R> {
    /// Position `q` \[rad\].
    pub q: R,
    /// Velocity `q̇` \[rad/s\].
    pub dq: R,
    /// Torque that acted (mean) since the previous sample \[N·m\]: after limits, delay and drive.
    pub tau_applied: R,
}

/// What the joint shall do at a sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reference<R> {
    /// Desired position \[rad\].
    pub q: R,
    /// Desired velocity \[rad/s\].
    pub dq: R,
    /// Desired acceleration \[rad/s²\].
    pub ddq: R,
}

/// The answer to one sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command<R> {
    /// Torque to apply until the next sample \[N·m\]: always finite and within the limits.
    pub tau: R,
    /// Estimate of the unknown dynamics \[N·m\], already contained in `tau`.
    pub phi_hat: R,
    /// What happened.
    pub status: Status,
}

/// What happened at a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Status {
    /// The torque limit acted.
    pub saturated: bool,
    /// The torque-rate limit acted.
    pub rate_limited: bool,
    /// The sample held something that is not finite, or beyond ±2³² (4.3e9): the last torque is held, the
    /// state untouched.
    pub refused: bool,
}

/// Everything a joint remembers between samples; owned by the caller.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState<R> {
    /// Observer: `φ̂_0, φ̂_1, …, φ̂_{m−1}`, estimates of `φ` and its time derivatives \[N·m/s^j\].
    /// Literal: `∫e, ∬e, …` \[rad·s^j\]. Unused entries are zero.
    pub(crate) memory: [R; ORDER_MAX],
    /// Literal: what rounding left out of the integrals, so that 1e9 samples later they still count.
    pub(crate) carry: [R; ORDER_MAX],
    /// Velocity at the last sample.
    pub(crate) dq: R,
    /// `φ̂` at the last sample.
    pub(crate) phi_hat: R,
    /// The last torque commanded.
    pub(crate) tau: R,
    pub(crate) started: bool,
}

/// The time between two samples, as the estimator takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval<R> {
    /// Length of one step \[s\].
    pub(crate) step: R,
    /// How many steps make the interval; 0: the interval cannot be trusted, nothing is integrated.
    pub(crate) parts: u8,
    /// `1/parts`.
    pub(crate) share: R,
}

impl<R: Real> JointState<R> {
    /// At rest, with zero knowledge of the arm and zero torque.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The last torque commanded \[N·m\].
    pub fn tau(&self) -> R {
        self.tau
    }

    /// The answer when nothing can be trusted: the last torque, the state untouched.
    pub(crate) fn hold(&self) -> Command<R> {
        let status = Status { refused: true, ..Status::default() };
        Command { tau: self.tau, phi_hat: self.phi_hat, status }
    }
}

impl<R: Real> Measurement<R> {
    /// See [`Real::doubt`].
    pub(crate) fn doubt(&self) -> R {
        R::doubt([self.q, self.dq, self.tau_applied])
    }
}

impl<R: Real> Reference<R> {
    /// At rest at a position.
    pub(crate) fn at_rest(q: R) -> Self {
        Self { q, ..Self::default() }
    }

    /// See [`Real::doubt`].
    pub(crate) fn doubt(&self) -> R {
        R::doubt([self.q, self.dq, self.ddq])
    }
}
