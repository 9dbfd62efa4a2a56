//! What is recorded of a trial.

use serde::{Deserialize, Serialize};

use crate::held::{JointFound, Violation};
use crate::second::Second;

/// How a trial ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ended {
    /// No study could be drawn.
    NoStudy,
    /// No gains.
    Infeasible,
    /// No claim.
    NotProved,
    /// Certified and run.
    Certified,
}

/// What is recorded of a trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its number in the attack.
    pub index: u64,
    /// What is in it.
    pub tags: Vec<String>,
    /// Number of joints.
    pub joints: usize,
    /// How it ended.
    pub ended: Ended,
    /// Why, where it was not certified.
    pub reason: String,
    /// Why drafts before it were no studies.
    pub redrawn: Vec<String>,
    /// Runs made, and how many of them the claim leaves out since a limit acted.
    pub runs: (usize, usize),
    /// Worst over the runs, per joint.
    pub found: Vec<JointFound>,
    /// Bounds that were left.
    pub violations: Vec<Violation>,
    /// What other simulators said, where they were asked.
    pub second: Option<Second>,
    /// At frozen postures: reached over claimed coupled gains, the most; `None`: not looked at.
    pub at_rest: Option<f64>,
    /// What `verify --study` said, where it was asked.
    pub derived: Option<String>,
    /// Time of design and verification, and of the runs \[s\].
    pub seconds: (f64, f64),
}
