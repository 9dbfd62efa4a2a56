//! Torque that is fed forward beside the reference: φ̂ is then what is left.

use super::memory::JointMemory;
use super::moment::Moment;
use crate::{JointGains, Real, Reference};

/// What the law is told at a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Told<R> {
    /// The reference in force, with `τ_ff/M̄` in its acceleration.
    pub(crate) reference: Reference<R>,
    /// `τ_ff` \[N·m\].
    pub(crate) fed: R,
    /// By how much that is more than at the last sample.
    pub(crate) more: R,
}

impl<R: Real> Told<R> {
    /// A reference, and nothing beside it: all that laws of the other forms are told.
    pub(crate) fn bare(reference: &Reference<R>) -> Self {
        Self { reference: *reference, fed: R::ZERO, more: R::ZERO }
    }
}

impl<R: Real> JointMemory<R> {
    /// What a law from positions is told of a reference.
    ///
    /// # Law
    ///
    /// `q̈_d + τ_ff/M̄`. Where a feed-forward begins, at the first sample of the law or later, `φ̂` gives up what it brings;
    /// where it ends, `φ̂` takes it over ([`JointState::feed`](crate::JointState)): `φ̂ + τ_ff` is what it was, and so is the torque.
    #[inline]
    pub(crate) fn tell(
        &mut self,
        gains: &JointGains<R>,
        reference: &Reference<R>,
        now: &Moment<R>,
    ) -> Told<R> {
        let mut told = Told::bare(reference);
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

    /// From here on so much is fed forward \[N·m\]; what `φ̂` was before gives it up.
    fn feed_from(&mut self, fed: R) {
        let more = fed - self.fed;
        self.steady = self.steady - more;
        for before in &mut self.before_now {
            *before = *before - more;
        }
        self.fed = fed;
    }

    /// `φ̂` takes over what is fed forward.
    pub(crate) fn take_over_feed(&mut self) {
        self.law.feed(-self.fed);
        self.unfed();
    }

    /// The law does not run any more, or stops the arm: `φ̂` is the whole, until it is told again.
    pub(crate) fn unfed(&mut self) {
        if self.feeds {
            self.feed_from(R::ZERO);
        }
        self.feeds = false;
    }
}
