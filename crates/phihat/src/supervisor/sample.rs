//! Inputs of a supervised sample, and the rules and states that belong to it.

use super::memory::{ArmState, JointMemory};
use super::rules::{ArmRules, JointRules};
use crate::{Measurement, ModeRequest, Reference, Stamp};

/// One sample of a whole arm: its measurements, with their number and time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a, R> {
    /// Number and time of the sample. Repeat the last one when none came.
    pub stamp: Stamp,
    /// Now \[ns\], by the clock of the stamp; only the age is taken from it.
    pub now_ns: u64,
    /// The joints, in the controller's order.
    pub joints: &'a [Measurement<R>],
}

/// Request of the caller at one sample: a mode, references and torques.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request<'a, R> {
    /// Requested mode.
    pub mode: ModeRequest,
    /// Reference of each joint; used in [`Mode::Tracking`](crate::Mode::Tracking), and compared with the pose
    /// before.
    pub references: &'a [Reference<R>],
    /// Torques that hold the arm \[N·m\], used when it is armed, each where it is finite and within ±2³²;
    /// without them the torque of the last stop, or zero.
    pub preset: Option<&'a [R]>,
    /// Torque per joint that is known to be needed along the reference in force, `τ_ff` \[N·m\], positive
    /// along the joint's axis: for instance the gravity of a description, its sign that of the torque that
    /// holds the arm. It is added to `M̄ q̈_d`.
    ///
    /// A law from positions gets `q̈_d + τ_ff/M̄`, and its `φ̂` is the rest of `φ`; the torque that holds the
    /// arm, and that [`Command::phi_hat`](crate::Command) reports, is `φ̂ + τ_ff`. Where a feed-forward
    /// begins, or ends with `None`, `φ̂` takes up the whole of it at that sample, and the torque does not
    /// change, however wrong it is: only the *variation* of a feed-forward moves the arm. A jump in it is one
    /// in torque, as a jump of `q̈_d` is, within the limits.
    ///
    /// One that is not finite, beyond ±2³² or of another length is refused: the last one is held, and that
    /// counts as a reference refused. While a sample is missed, in a [`Funnel`](crate::Funnel) and in every
    /// mode where the law does not run, it is not used; the other forms of the law never use it: their
    /// observers would take it for `φ`.
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

/// State of an arm and of its joints, in the controller's order.
#[derive(Debug, PartialEq)]
pub struct Memories<'a, R> {
    /// The arm's.
    pub arm: &'a mut ArmState,
    /// The joints'.
    pub joints: &'a mut [JointMemory<R>],
}
