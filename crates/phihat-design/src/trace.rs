//! Recorded signals of a joint, and an interval of its inertia.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::undetermined::Undetermined;

/// Recorded signals of one joint, one entry per sample, all of the same length.
#[derive(Debug, Clone, Copy)]
pub struct JointSignals<'a> {
    /// Joint name.
    pub name: &'a str,
    /// Position \[rad\].
    pub q: &'a [f64],
    /// Velocity \[rad/s\].
    pub dq: &'a [f64],
    /// Acceleration \[rad/s²\].
    pub ddq: &'a [f64],
    /// Torque that acted \[N·m\].
    pub tau: &'a [f64],
}

/// Interval of one joint's effective inertia `M_ii` from records: an estimate, not a proof. Postures that no record
/// visits are not in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InertiaEstimate {
    /// Lower end \[kg·m²\].
    pub low_kg_m2: f64,
    /// Upper end \[kg·m²\].
    pub high_kg_m2: f64,
    /// Records that give an interval each; this one contains all of them.
    pub records: usize,
}

/// Why a trace tells no inertia.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum EstimateError {
    /// Signals of different length, or none.
    #[error("joint {joint}: {found} samples where {expected} are expected")]
    Length {
        /// Joint name.
        joint: String,
        /// Samples found.
        found: usize,
        /// Samples of the first joint's position.
        expected: usize,
    },
    /// A record does not determine a joint's inertia.
    #[error("joint {joint}: this record cannot tell its inertia: {why}")]
    Undetermined {
        /// Joint name.
        joint: String,
        /// The reason, and the motion that would.
        why: Undetermined,
    },
}
