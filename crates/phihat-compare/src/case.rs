//! A run that counts, and what is recorded of it.

use serde::{Deserialize, Serialize};

use crate::row::GainsKind;
use crate::run_outcome::{Figures, RunOutcome, Sketch};

/// A run that counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ComparisonCase {
    pub(crate) arm: usize,
    pub(crate) rival: usize,
    pub(crate) world: usize,
    pub(crate) gains: GainsKind,
    pub(crate) seed: u64,
}

/// Record of a run that counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Scored {
    #[serde(rename = "fate")]
    pub(crate) outcome: RunOutcome,
    pub(crate) figures: Option<Figures>,
    pub(crate) sketch: Option<Sketch>,
}
