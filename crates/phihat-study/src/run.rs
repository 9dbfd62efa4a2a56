//! The run that a reference is for, and the way from rest to rest.

use crate::base::Base;

/// Largest slope of the quintic 10s³ − 15s⁴ + 6s⁵ from rest to rest, at its middle.
pub(crate) const QUINTIC_SLOPE_MAX: f64 = 1.875;

/// The run that a reference is for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReferenceRun<'p> {
    /// \[s\]
    pub(crate) duration: f64,
    /// Control samples per second \[Hz\].
    pub(crate) rate: f64,
    /// Seed of the study.
    pub(crate) seed: u64,
    /// Directory to which files are relative.
    pub(crate) base: Base<'p>,
}
