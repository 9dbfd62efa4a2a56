//! State of a supervised arm between samples; owned by the caller.

use super::arrivals::Arrivals;
use super::blend::{Blend, fade};
use super::monitor::{Actuation, Frozen, Oscillation};
use super::stopping::Stopping;
use crate::{Braking, Command, Fault, JointState, Measurement, Mode, ModeRequest, Real, Reference};

/// State of the arm as a whole: mode, fault, counters.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ArmState {
    pub(crate) arrivals: Arrivals,
    pub(crate) mode: Mode,
    pub(crate) request: ModeRequest,
    pub(crate) fault: Option<(Fault, usize)>,
    /// Fault that the law detected at the last sample.
    pub(crate) pending: Option<(Fault, usize)>,
    /// Samples since the mode was entered.
    pub(crate) in_mode: u32,
    /// Samples since the law took over.
    pub(crate) engaged: u32,
    /// Samples since the reference began to blend.
    pub(crate) blending: u32,
    /// Samples in a row that the mismatch is settled, and disturbed.
    pub(crate) settled: u32,
    pub(crate) disturbed: u32,
    /// The running gains are in force, not the start gains.
    pub(crate) raised: bool,
    /// The caller feeds forward.
    pub(crate) feeds: bool,
    /// References refused in a row.
    pub(crate) bad_references: u32,
    /// Control that may still act on the joints' torque.
    pub(crate) trust: Trust,
    /// Samples since the brakes were requested in this stop; `None`: they were not.
    pub(crate) braking: Option<u32>,
    /// Samples since `JointMemory::before_now` was written.
    pub(crate) block: u32,
    /// Samples left to wait for a sound velocity after a gap; and true if the missed samples came but were
    /// refused.
    pub(crate) gap: u8,
    pub(crate) jumped: bool,
    /// Trust once the sensors are sound again: a position that jumped may stay wrong, or be another joint's.
    pub(crate) regains: Trust,
    /// Samples of a stop in a row whose positions and velocities agree.
    pub(crate) sound: u32,
    /// Largest error of a joint at this sample, as a share of its bound.
    pub(crate) error_share: f32,
}

/// Control that may still act on the joints' torque in a stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) enum Trust {
    /// None: the drive does not follow its command.
    Nothing,
    /// Positions of several joints jumped, and their velocities may be other joints': the torque that held the
    /// arm before.
    Held,
    /// Positions could not be believed: the torque that held the arm before, and damping.
    Damper,
    /// The law may be what shakes the arm: that, softly, and a spring.
    Spring,
    /// The law.
    #[default]
    Law,
}

impl Fault {
    /// Returns true if `φ̂` may contain the cause of the stop: an earlier `φ̂` then holds the arm.
    pub(crate) fn is_learnt(self) -> bool {
        match self {
            Self::LinkLost
            | Self::LinkQuality
            | Self::BadSample
            | Self::BadReference
            | Self::Frozen
            | Self::Clock => false,
            Self::JointLimit
            | Self::TrackingError
            | Self::ErrorBound
            | Self::Overspeed
            | Self::Oscillation
            | Self::Actuation
            | Self::Saturation
            | Self::NotFinite => true,
        }
    }

    /// Control that may still act after this fault.
    pub(crate) fn leaves(self) -> Trust {
        match self {
            Self::Actuation => Trust::Nothing,
            Self::BadSample | Self::Frozen => Trust::Damper,
            Self::Oscillation => Trust::Spring,
            _ => Trust::Law,
        }
    }
}

impl ArmState {
    /// The state before the first sample: idle, with nothing known.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The mode that the arm is in.
    pub fn mode(&self) -> Mode {
        self.mode
    }
}

/// State of one joint: law, last sample, reference, monitors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointMemory<R> {
    pub(crate) law: JointState<R>,
    /// The last sample believed.
    pub(crate) measured: Measurement<R>,
    /// The reference in force: shaped and blended.
    pub(crate) reference: Reference<R>,
    /// Rest of the braking motion by which the reference stays in its box.
    pub(crate) braking: Braking<R>,
    /// The caller's last finite reference.
    pub(crate) asked: Reference<R>,
    /// The caller's last finite feed-forward \[N·m\].
    pub(crate) fed_asked: R,
    /// Feed-forward at the last sample in addition to `M̄ q̈_d` \[N·m\]; and true if there was one.
    pub(crate) fed: R,
    pub(crate) feeds: bool,
    /// The pose that is held.
    pub(crate) home: R,
    /// The torque that is held when the law does not run.
    pub(crate) held: R,
    /// `φ̂`, averaged over some 50 ms.
    pub(crate) steady: R,
    /// The same as it was up to a block of samples ago, and up to two: from before what stops the arm now.
    pub(crate) before_now: [R; 2],
    pub(crate) stopping: Stopping<R>,
    /// Least and largest torque commanded lately \[N·m\].
    pub(crate) commanded: [R; 2],
    /// Samples in a row in which the joint was too fast, and in which its torque was at its limit.
    pub(crate) fast: u32,
    pub(crate) saturated: u32,
    /// Samples in a row in which the error was beyond its bound.
    pub(crate) beyond: u32,
    pub(crate) blend: Blend<R>,
    /// `M̄, K_d, K_p` that were in force until this sample, when they have changed.
    pub(crate) before: Option<[R; 3]>,
    /// Torque that is faded out, and for how many samples already.
    offset: R,
    offset_age: u32,
    /// Mean mismatch `φ − φ̂`, and its mean square.
    pub(crate) mismatch: R,
    pub(crate) mismatch_square: R,
    /// Width of the funnel above its final one; negative: the estimator has taken over.
    pub(crate) funnel: R,
    pub(crate) funnel_settled: u32,
    pub(crate) frozen: Frozen<R>,
    pub(crate) oscillation: Oscillation<R>,
    pub(crate) actuation: Actuation<R>,
}

impl<R: Real> JointMemory<R> {
    /// The memory before the first sample.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The reference in force at the last sample: shaped and blended.
    pub fn reference(&self) -> &Reference<R> {
        &self.reference
    }

    /// The last torque that this joint was commanded \[N·m\].
    pub fn tau(&self) -> R {
        self.law.tau
    }

    /// Estimate of `φ` in the last command \[N·m\]: `φ̂` plus [`Self::feed_forward`].
    pub fn phi_hat(&self) -> R {
        whole(self.law.phi_hat, self.fed)
    }

    /// Feed-forward part of [`Self::phi_hat`] \[N·m\]; the rest is estimated.
    pub fn feed_forward(&self) -> R {
        self.fed
    }

    /// The answer when nothing can be trusted: the last torque, the state untouched.
    pub(crate) fn hold(&self) -> Command<R> {
        Command { phi_hat: self.phi_hat(), ..self.law.hold() }
    }

    /// Starts to fade a torque out.
    pub(crate) fn fade_out(&mut self, torque: R) {
        self.offset = torque;
        self.offset_age = 0;
    }

    /// Rest of that torque at this sample \[N·m\]; `rate` is the share per sample.
    pub(crate) fn fading(&mut self, rate: R) -> R {
        if self.offset == R::ZERO {
            return self.offset;
        }
        let progress = R::from_f64(f64::from(self.offset_age)) * rate;
        if progress < R::from_f64(1.0) {
            self.offset_age = self.offset_age.saturating_add(1);
            self.offset * fade(progress)
        } else {
            self.offset = R::ZERO;
            R::ZERO
        }
    }
}

/// `φ̂ + τ_ff`: bit for bit `φ̂` without a feed-forward.
pub(crate) fn whole<R: Real>(phi_hat: R, fed: R) -> R {
    if fed == R::ZERO { phi_hat } else { phi_hat + fed }
}
