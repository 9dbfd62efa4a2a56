//! Inputs, output and state of one joint's law.

use crate::delay::PENDING_MAX;
use crate::innovation::{Filtered, SECTIONS_MAX};
use crate::{Form, ORDER_MAX, Real};

/// Number of entries of a [`JointState`].
pub const STATE_ENTRIES: usize = 2 * ORDER_MAX + 2 + 2 * PENDING_MAX + 1 + 2 * SECTIONS_MAX + 3;

/// Meaning of an entry of [`JointState::entries`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum StateEntry {
    /// An estimate or an integral \[rad/s^power\], of a torque or its derivative after division by `M̄`.
    Estimate {
        /// Exponent of 1/s in its unit.
        power: i8,
    },
    /// Rounding that an integral has left out, in its unit.
    Rounding,
    /// State of a filter on the innovation \[rad\].
    Filter,
    /// Velocity at the last sample \[rad/s\].
    Velocity,
    /// A torque of the last samples \[N·m\].
    Torque,
    /// A torque that was fed forward at one of the last samples \[N·m\].
    FeedForward,
}

/// Measurement of one joint at one sample.
///
/// # Example
///
/// ```
/// use phihat::Measurement;
///
/// // From the robot's message. Where torque is not measured: the torque that was commanded, see `Delay`.
/// let measurement = Measurement { q: 0.31, dq: -0.02, tau_applied: 4.7 };
/// assert!(measurement.tau_applied > 0.0); // positive along the joint's axis
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measurement<R> {
    /// Position `q` \[rad\].
    pub q: R,
    /// Velocity `q̇` \[rad/s\].
    pub dq: R,
    /// Torque that acted (mean) since the previous sample \[N·m\]: after limits, delay and drive.
    pub tau_applied: R,
}

/// Reference of one joint at one sample: position, velocity and acceleration.
///
/// # Example
///
/// ```
/// use phihat::Reference;
///
/// // A sine of 0.2 rad at 3 rad/s, with its derivatives. A hold has both derivatives zero.
/// let at = |t: f64| {
///     let (s, c) = (3.0 * t).sin_cos();
///     Reference { q: 0.2 * s, dq: 0.6 * c, ddq: -1.8 * s }
/// };
/// let hold = Reference { q: 0.2, ..Reference::default() };
/// assert_eq!(at(0.0), Reference { q: 0.0, dq: 0.6, ddq: 0.0 });
/// assert_eq!((hold.dq, hold.ddq), (0.0, 0.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reference<R> {
    /// Desired position \[rad\].
    pub q: R,
    /// Desired velocity \[rad/s\].
    pub dq: R,
    /// Desired acceleration \[rad/s²\].
    pub ddq: R,
}

/// The torque that one joint applies until the next sample, and what is known of it.
///
/// # Example
///
/// ```
/// use phihat::{Form, JointDesign, JointGains, JointState, Limits, Measurement, Reference};
///
/// let design = JointDesign {
///     inertia: 0.8, kp: 400.0, kd: 40.0, a: &[4900.0, 140.0], period: 1e-3, form: Form::Observer,
/// };
/// let limits = Limits::new(Some(2.0), None, 1e-3)?; // 2 N·m
/// let gains = JointGains::new(&design)?.with_limits(limits);
///
/// // 0.1 rad above the reference: the law asks for −M̄ K_p e = −32 N·m, and the limit says that it acted.
/// let measurement = Measurement { q: 0.1, dq: 0.0, tau_applied: 0.0 };
/// let command = gains.update(&mut JointState::new(), &measurement, &Reference::default());
/// assert_eq!(command.tau, -2.0);
/// assert!(command.status.saturated && !command.status.refused);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command<R> {
    /// Torque to apply until the next sample \[N·m\]: always finite and within the limits.
    pub tau: R,
    /// Estimate of the unknown dynamics \[N·m\], already contained in `tau`; from a supervisor with a
    /// feed-forward, `φ̂ + τ_ff`: the torque that holds the arm.
    pub phi_hat: R,
    /// Effect of checks and limits on this command.
    pub status: Status,
}

/// Effect of checks and limits on one joint's command.
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

/// State of a joint between samples; owned by the caller.
///
/// # Example
///
/// ```
/// use phihat::{Form, JointDesign, JointGains, JointState, Measurement, Reference};
///
/// let design = JointDesign {
///     inertia: 0.8, kp: 400.0, kd: 40.0, a: &[4900.0, 140.0], period: 1e-3, form: Form::Observer,
/// };
/// let gains = JointGains::<f64>::new(&design)?;
///
/// // The joint hangs in 5 N·m of gravity and does not move: φ̂ learns that within a fraction of a second.
/// let mut state = JointState::new();
/// let held = Measurement { q: 0.0, dq: 0.0, tau_applied: 5.0 };
/// for _ in 0..500 {
///     gains.update(&mut state, &held, &Reference::default());
/// }
/// assert!((state.tau() - 5.0).abs() < 1e-6);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState<R> {
    /// Observer: `φ̂_0, φ̂_1, …, φ̂_{m−1}`, estimates of `φ` and its time derivatives \[N·m/s^j\].
    /// Literal: `∫e, ∬e, …` \[rad·s^j\]. Unused entries are zero.
    pub(crate) memory: [R; ORDER_MAX],
    /// Literal: what rounding left out of the integrals, so that 1e9 samples later they still count.
    pub(crate) carry: [R; ORDER_MAX],
    /// From positions: `ê` \[rad\] and `ė̂` \[rad/s\].
    pub(crate) motion: [R; 2],
    /// From positions: what of the last torques is not feed-forward \[N·m\], the newest first.
    pub(crate) pending: [R; PENDING_MAX],
    /// From positions: the feed-forward of the last samples \[N·m\], the newest first.
    pub(crate) feedforward: [R; PENDING_MAX + 1],
    /// From positions: state of the innovation filter.
    pub(crate) filtered: Filtered<R>,
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
pub(crate) struct SampleInterval<R> {
    /// Length of one step \[s\].
    pub(crate) step: R,
    /// Number of steps in the interval; 0: the interval cannot be trusted, nothing is integrated.
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

    /// Everything that it remembers, in an order that stays the same within a version; their meaning depends on the
    /// form of the law. With [`Self::of_entries`] the law can be played: a unit in one entry, and what a sample makes
    /// of it.
    ///
    /// ```
    /// use phihat::JointState;
    /// let state = JointState::<f64>::of_entries(&core::array::from_fn(|i| i as f64));
    /// assert_eq!(state.entries()[3], 3.0);
    /// ```
    pub fn entries(&self) -> [R; STATE_ENTRIES] {
        let mut own = *self;
        let mut out = [R::ZERO; STATE_ENTRIES];
        for (into, value) in out.iter_mut().zip(own.each()) {
            *into = *value;
        }
        out
    }

    /// Meaning of each entry for a law of this form.
    pub fn meaning(form: Form) -> [StateEntry; STATE_ENTRIES] {
        use StateEntry::{Estimate, FeedForward, Filter, Rounding, Torque, Velocity};
        let memory = [1_i8, 2, 3, 4]
            .into_iter()
            .map(|j| Estimate { power: if form == Form::Literal { -j } else { 1 + j } });
        let carry = core::iter::repeat_n(Rounding, ORDER_MAX);
        let motion = [Estimate { power: 0 }, Estimate { power: 1 }];
        let torques = core::iter::repeat_n(Torque, PENDING_MAX);
        let fed = core::iter::repeat_n(FeedForward, PENDING_MAX + 1);
        let filter = core::iter::repeat_n(Filter, 2 * SECTIONS_MAX);
        let all = memory.chain(carry).chain(motion).chain(torques).chain(fed).chain(filter);
        let mut out = [Torque; STATE_ENTRIES];
        for (into, entry) in out.iter_mut().zip(all.chain([Velocity, Torque, Torque])) {
            *into = entry;
        }
        out
    }

    /// A state after some sample that remembers these entries, in the order of [`Self::entries`].
    pub fn of_entries(entries: &[R; STATE_ENTRIES]) -> Self {
        let mut state = Self { started: true, ..Self::default() };
        for (into, value) in state.each().zip(entries) {
            *into = *value;
        }
        state
    }

    fn each(&mut self) -> impl Iterator<Item = &mut R> {
        let observer = self.memory.iter_mut().chain(&mut self.carry).chain(&mut self.motion);
        let torques = self.pending.iter_mut().chain(&mut self.feedforward);
        let filter = self.filtered.iter_mut().flatten();
        let last = [&mut self.dq, &mut self.phi_hat, &mut self.tau];
        observer.chain(torques).chain(filter).chain(last)
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
