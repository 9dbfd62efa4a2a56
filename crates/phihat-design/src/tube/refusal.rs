//! Why a study has no tube.

use thiserror::Error;

/// Why there is no tube.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TubeRefusal {
    /// The linear loop does not have this part of the study.
    #[error("`{0}` is not in the loop that a tube is about")]
    Unsupported(String),
    /// The payload cannot be attached.
    #[error("payload: {0}")]
    Payload(String),
    /// A limit could act.
    #[error(
        "the {} limit can act at t = {t:.3} s on joint {joint}",
        if *torque { "torque" } else { "torque-rate" }
    )]
    Limit {
        /// Joint.
        joint: String,
        /// When \[s\].
        t: f64,
        /// The torque limit, not that of its rate.
        torque: bool,
    },
    /// The nominal run diverges.
    #[error("the run itself diverges at t = {t:.3} s on joint {joint}")]
    Diverges {
        /// Joint.
        joint: String,
        /// When \[s\].
        t: f64,
    },
    /// No bounds were found that one evaluation confirms.
    #[error(
        "the bounds on joint {joint} grow without end at t = {t:.3} s: the intervals are too wide for these gains"
    )]
    Open {
        /// Joint.
        joint: String,
        /// When \[s\].
        t: f64,
    },
}
