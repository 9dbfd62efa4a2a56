//! Record of a trial.

use serde::{Deserialize, Serialize};

use crate::held::{JointFound, Violation};
use crate::second::SecondOpinion;

/// Outcome of a trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialEnded {
    /// No study could be drawn.
    NoStudy,
    /// No gains.
    Infeasible,
    /// No claim.
    NotProved,
    /// Certified and run.
    Certified,
}

/// Runs against the tube by the second derivation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SecondDerivation {
    /// Runs.
    pub runs: usize,
    /// Largest ratio of its error bound of a joint to that of the first.
    pub wider: f64,
}

/// Recorded result of a trial.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AttackRecord {
    /// Its number in the attack.
    pub index: u64,
    /// Names of the study's features.
    pub tags: Vec<String>,
    /// Number of joints.
    pub joints: usize,
    /// Outcome of the trial.
    pub ended: TrialEnded,
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
    /// Result of other simulators, where requested.
    pub second: Option<SecondOpinion>,
    /// At frozen postures: reached over claimed coupled gains, the most; `None`: not looked at.
    pub at_rest: Option<f64>,
    /// Result of `verify --study`, where requested.
    pub derived: Option<String>,
    /// The same runs against the tube by the second derivation; `None`: not asked, or it does not close.
    #[serde(default)]
    pub second_derivation: Option<SecondDerivation>,
    /// Time of design and verification, and of the runs \[s\].
    pub seconds: (f64, f64),
}
