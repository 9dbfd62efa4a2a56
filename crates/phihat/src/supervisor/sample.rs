//! What comes in at a sample, and what belongs together around it.

use super::memory::{ArmState, JointMemory};
use super::rules::{ArmRules, JointRules};
use crate::{Measurement, ModeRequest, Reference, Stamp};

/// One sample of a whole arm: its measurements, with their number and time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a, R> {
    /// Which sample it is. Repeat the last one when none came.
    pub stamp: Stamp,
    /// Now \[ns\], by the clock of the stamp; only the age is taken from it.
    pub now_ns: u64,
    /// The joints, in the controller's order.
    pub joints: &'a [Measurement<R>],
}

/// What the caller asks for at one sample: a mode and references.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request<'a, R> {
    /// Which mode.
    pub mode: ModeRequest,
    /// Where each joint shall be; heeded in [`Mode::Tracking`](crate::Mode::Tracking), and compared with the pose before.
    pub references: &'a [Reference<R>],
    /// Torques that hold the arm, heeded when it is armed, each where it is finite and within ±2³²; without them
    /// the torque of the last stop, or zero.
    pub preset: Option<&'a [R]>,
}

/// The rules of an arm and of its joints, in the controller's order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rules<'a, R> {
    /// The arm's.
    pub arm: &'a ArmRules<R>,
    /// The joints'.
    pub joints: &'a [JointRules<R>],
}

/// What an arm and its joints remember, in the controller's order.
#[derive(Debug, PartialEq)]
pub struct Memories<'a, R> {
    /// The arm's.
    pub arm: &'a mut ArmState,
    /// The joints'.
    pub joints: &'a mut [JointMemory<R>],
}
