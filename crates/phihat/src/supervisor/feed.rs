//! Feed-forward torque in addition to the reference: φ̂ is then the rest.

use super::memory::JointMemory;
use super::moment::ArmMoment;
use crate::{JointGains, Real, Reference};

/// Inputs of the law at a sample: reference and feed-forward.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LawInputs<R> {
    /// The reference in force, with `τ_ff/M̄` in its acceleration.
    pub(crate) reference: Reference<R>,
    /// `τ_ff` \[N·m\].
    pub(crate) fed: R,
    /// Increase of `τ_ff` since the last sample \[N·m\].
    pub(crate) more: R,
}

impl<R: Real> LawInputs<R> {
    /// A reference without feed-forward: the input of laws of the other forms.
    pub(crate) fn bare(reference: &Reference<R>) -> Self {
        Self { reference: *reference, fed: R::ZERO, more: R::ZERO }
    }
}

impl<R: Real> JointMemory<R> {
    /// Input of a law from positions: the reference with the feed-forward.
    ///
    /// # Law
    ///
    /// `q̈_d + τ_ff/M̄`. Where a feed-forward begins, at the first sample of the law or later, `φ̂` is
    /// reduced by it; where it ends, `φ̂` takes it over ([`JointState::feed`](crate::JointState)):
    /// `φ̂ + τ_ff` is what it was, and so is the torque.
    #[inline]
    pub(crate) fn tell(
        &mut self,
        gains: &JointGains<R>,
        reference: &Reference<R>,
        now: &ArmMoment<R>,
    ) -> LawInputs<R> {
        let mut told = LawInputs::bare(reference);
        if !(now.feeds || self.feeds) {
            return told;
        }
        if now.feeds {
            told.fed = self.fed_asked;
        }
        if now.feeds != self.feeds {
            self.feeds = now.feeds;
            self.law.feed(told.fed - self.fed);
            self.feed_from(told.fed);
        }
        told.more = told.fed - self.fed;
        told.reference.ddq += told.fed * gains.inertia_inverse;
        told
    }

    /// Sets the feed-forward \[N·m\]; the stored means of `φ̂` are reduced by the increase.
    fn feed_from(&mut self, fed: R) {
        let more = fed - self.fed;
        self.steady = self.steady - more;
        for before in &mut self.before_now {
            *before = *before - more;
        }
        self.fed = fed;
    }

    /// `φ̂` takes over the feed-forward.
    pub(crate) fn take_over_feed(&mut self) {
        self.law.feed(-self.fed);
        self.unfed();
    }

    /// Ends the feed-forward where the law does not run any more, or stops the arm: the stored means of `φ̂`
    /// are then the whole.
    pub(crate) fn unfed(&mut self) {
        if self.feeds {
            self.feed_from(R::ZERO);
        }
        self.feeds = false;
    }
}
