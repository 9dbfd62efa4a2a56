//! A whole number of samples of transport delay, without a heap.

use crate::Real;

/// Longest delay \[samples\].
pub const DELAY_MAX: usize = 8;

/// Longest transport delay that a law from positions predicts across \[samples\].
pub(crate) const PENDING_MAX: usize = 4;

/// A delay line: what comes out is what went in `samples` calls ago, zero before that.
///
/// A controller that knows its transport delay, and cannot measure the torque, feeds the observer with
/// what this line answers: the torque that was acting during the measured interval.
///
/// ```
/// use phihat::Delay;
/// let mut line = Delay::<f64>::new(1)?;
/// assert_eq!([line.pass(5.0), line.pass(6.0)], [0.0, 5.0]);
/// # Ok::<(), phihat::DelayTooLong>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay<R> {
    ring: [R; DELAY_MAX],
    samples: usize,
    at: usize,
}

/// The requested delay is longer than [`DELAY_MAX`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DelayTooLong {
    /// Requested delay \[samples\].
    pub samples: usize,
}

impl core::fmt::Display for DelayTooLong {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "a delay of {} samples; at most {DELAY_MAX} are possible", self.samples)
    }
}

impl core::error::Error for DelayTooLong {}

impl<R: Real> Delay<R> {
    /// A line of `samples` calls, filled with zero.
    ///
    /// # Errors
    ///
    /// [`DelayTooLong`] beyond [`DELAY_MAX`].
    pub fn new(samples: usize) -> Result<Self, DelayTooLong> {
        if samples > DELAY_MAX {
            return Err(DelayTooLong { samples });
        }
        Ok(Self { ring: [R::ZERO; DELAY_MAX], samples, at: 0 })
    }

    /// Takes `value` in, gives back the one from `samples` calls ago.
    pub fn pass(&mut self, value: R) -> R {
        if self.samples == 0 {
            return value;
        }
        let Some(slot) = self.ring.get_mut(self.at) else { return value };
        let oldest = core::mem::replace(slot, value);
        self.at = if self.at + 1 < self.samples { self.at + 1 } else { 0 };
        oldest
    }
}
