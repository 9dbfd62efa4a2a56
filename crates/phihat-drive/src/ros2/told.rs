//! Options, counts and samples of a node.

use std::net::IpAddr;

use serde::Serialize;
use thiserror::Error;

use crate::tape::Cycle;

/// Joints of a message that goes through the ring.
pub(super) const JOINTS_MOST: usize = 32;

/// Options of a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RosOptions {
    /// The DDS domain.
    pub domain: u16,
    /// Addresses of the interfaces that are used; none: all.
    pub networks: Vec<IpAddr>,
    /// Every how many samples joint states are published.
    pub every: u64,
}

/// Number of messages of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct RosCounts {
    /// Samples that were published, as six messages each.
    pub states: u64,
    /// Messages about the mode.
    pub modes: u64,
    /// Messages of diagnostics.
    pub diagnostics: u64,
    /// Positions that were requested.
    pub commands: u64,
    /// Trajectories that were requested.
    pub trajectories: u64,
    /// Of both, those that were refused.
    pub refused: u64,
    /// Samples that the node was too slow for.
    pub dropped: u64,
}

/// Why there is no node.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RosError {
    /// DDS does not start, or a topic cannot be made.
    #[error("--ros2: {0}")]
    Node(String),
    /// The arm has more joints than a message through the ring.
    #[error("--ros2: {0} joints; up to {JOINTS_MOST} are valid")]
    Joints(usize),
}

/// One joint of a sample.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JointSample {
    pub(super) q: f64,
    pub(super) dq: f64,
    pub(super) tau: f64,
    pub(super) q_desired: f64,
    pub(super) dq_desired: f64,
    pub(super) command: f64,
    pub(super) phi_hat: f64,
    /// Measured error as a share of its certified bound.
    pub(super) share: f64,
}

/// One sample, of fixed size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Snapshot {
    pub(super) cycle: Cycle,
    pub(super) lost: u64,
    pub(super) dropped: u64,
    /// Largest share so far, with its joint; 0: there is no bound, or none was compared yet.
    pub(super) largest: (f64, usize),
    pub(super) joints: [JointSample; JOINTS_MOST],
}
