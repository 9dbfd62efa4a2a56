//! A rival at work, whatever it is.

use core::fmt::Debug;

use crate::handed::All;

/// A rival that runs, whatever it is.
pub trait Running: Debug + Send {
    /// One sample: leaves the torques \[N·m\] in `tau`, before any limit.
    fn update(&mut self, all: &All<'_>, tau: &mut [f64]);
    /// Scalars that it remembers from one sample to the next.
    fn states(&self) -> usize;
}
