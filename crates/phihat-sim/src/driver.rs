//! The seam for a controller that is not this project's law.

use core::fmt::Debug;

use phihat::{Command, Reference};

use crate::sample::Sample;

/// A controller of somebody else's: it is asked once per control sample, and the study's torque limits act on
/// what it answers.
pub trait Driver: Debug + Send {
    /// Leaves the torque of every joint \[N·m\] in `tau`, which holds the last answer. What is not finite is
    /// refused and the torque before held.
    fn drive(&mut self, moment: &Moment<'_>, tau: &mut [f64]);
}

/// All that a controller can be handed at a control sample. An adapter hands on what its controller declares
/// to need.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// Time since the start of the run \[s\].
    pub t: f64,
    /// Measurements of this sample.
    pub sample: &'a Sample,
    /// References of this sample, one entry per joint.
    pub references: &'a [Reference<f64>],
    /// The commands before this one, with what the limits did to them.
    pub last: &'a [Command<f64>],
}
