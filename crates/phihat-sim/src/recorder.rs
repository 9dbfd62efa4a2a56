//! Recorders of the samples of a run, chosen by the caller.

use core::convert::Infallible;

use crate::trace::Trace;

/// Samples that are handed over at once where only figures are stored: those of seven joints fit in a core's
/// own cache.
pub const FIGURES_BLOCK: usize = 64;

/// Takes the samples of a run as they come, for [`Simulation::record`](crate::Simulation::record).
///
/// | recorder | keeps | memory |
/// |---|---|---|
/// | [`Trace`] | every signal of every sample | grows with the run |
/// | [`Measured`](crate::Measured), [`Surviving`](crate::Surviving) | figures alone | a block |
/// | [`ParquetTrace`](crate::ParquetTrace), [`TraceWriter`](crate::TraceWriter) | a file | a block |
/// | a pair of recorders, the second one of figures | what both keep | both |
///
/// Whichever is chosen, a figure is the same to the last bit.
pub trait Recorder {
    /// Why samples were not taken; the run ends there.
    type Error;

    /// Number of samples per block, for a run of so many samples; the default suits a recorder that stores
    /// figures.
    fn room(&self, _samples: usize) -> usize {
        FIGURES_BLOCK
    }

    /// Takes the next samples. It may take them out of the block and leave it empty.
    ///
    /// # Errors
    ///
    /// [`Self::Error`] if it cannot take them.
    fn take(&mut self, block: &mut Trace) -> Result<(), Self::Error>;
}

/// The whole record.
impl Recorder for Trace {
    type Error = Infallible;

    fn room(&self, samples: usize) -> usize {
        samples
    }

    fn take(&mut self, block: &mut Trace) -> Result<(), Infallible> {
        *self = core::mem::take(block);
        Ok(())
    }
}

/// Both: the first one, which must not empty the block, and beside it one that takes every sample.
impl<A: Recorder, B: Recorder<Error = Infallible>> Recorder for (A, B) {
    type Error = A::Error;

    fn room(&self, samples: usize) -> usize {
        self.0.room(samples).max(self.1.room(samples))
    }

    fn take(&mut self, block: &mut Trace) -> Result<(), A::Error> {
        self.0.take(block)?;
        let Ok(()) = self.1.take(block);
        Ok(())
    }
}
