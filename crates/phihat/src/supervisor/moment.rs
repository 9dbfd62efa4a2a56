//! State of the arm at a sample that the laws of all joints use.

use crate::joint::SampleInterval;

/// Task of the law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Aim {
    /// It holds a pose.
    Hold,
    /// It follows the reference.
    Track,
    /// It brings the arm to rest.
    Stop,
}

impl<R> ArmMoment<R> {
    /// Returns true if the law brings the arm to rest.
    pub(crate) fn stops(&self) -> bool {
        self.aim == Aim::Stop
    }
}

/// State of the arm at a sample, the same for every joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ArmMoment<R> {
    pub(crate) interval: SampleInterval<R>,
    /// Progress of the reference's blend, from 0; over at 1. Its length \[s\].
    pub(crate) reference_progress: R,
    pub(crate) blend: R,
    /// Progress per sample.
    pub(crate) blend_rate: R,
    pub(crate) aim: Aim,
    /// True if the stop has lasted a second: what pushed the arm into it is over.
    pub(crate) alone: bool,
    /// The caller feeds forward.
    pub(crate) feeds: bool,
    pub(crate) first_motion: bool,
    /// Samples in a row with the torque at its limit that are a fault.
    pub(crate) saturation: u32,
    /// Share of a sample in what is averaged over `AVERAGING_S`.
    pub(crate) average: R,
    /// Samples that count as a while: 0.1 s or so.
    pub(crate) dwell: u32,
}
