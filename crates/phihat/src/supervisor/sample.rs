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
    /// Torque per joint that is known to be needed along the reference in force, `τ_ff` \[N·m\], positive along the joint's axis: for
    /// instance the gravity of a description, its sign that of the torque that holds the arm. It goes in beside `M̄ q̈_d`.
    ///
    /// A law from positions is told `q̈_d + τ_ff/M̄`, and its `φ̂` is what is left of `φ`; what holds the arm, and
    /// [`Command::phi_hat`](crate::Command) says, is `φ̂ + τ_ff`. Where a feed-forward begins, or ends with `None`, `φ̂` takes up the
    /// whole of it at that sample, and the torque does not change, however wrong it is: only by how a feed-forward *varies* does it move the arm. A jump
    /// in it is one in torque, as a jump of `q̈_d` is, within the limits.
    ///
    /// One that is not finite, beyond ±2³² or of another length is refused: the last one is held, and that counts as a reference
    /// refused. While a sample is missed, in a [`Funnel`](crate::Funnel) and in every mode where the law does not run, it is not heeded; the other
    /// forms of the law never heed it: their observers would take it for `φ`.
    pub feed_forward: Option<&'a [R]>,
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
