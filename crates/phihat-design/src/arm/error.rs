//! Why nothing can be said of an arm's inertia.

use thiserror::Error;

/// Why the range cannot be found.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ArmError {
    /// The payload cannot be attached.
    #[error("payload: {0}")]
    Payload(String),
    /// A mass matrix has an entry that is not a number.
    #[error(
        "the mass matrix of the robot is not finite at q = {0:?}: check masses, inertias, rotor inertias and \
         lengths in its description"
    )]
    NotFinite(Vec<f64>),
    /// The inertia has no range in the nominal inertias.
    #[error(
        "the arm's inertia reaches from {low:e} to {high:e} times M̄ = {nominal:?} kg m^2; a range has to be \
         above 0, finite, and its ends less than 1e13 apart: check M̄, masses and rotor inertias"
    )]
    Range {
        /// Smallest eigenvalue.
        low: f64,
        /// Largest eigenvalue.
        high: f64,
        /// Nominal inertias \[kg·m²\].
        nominal: Vec<f64>,
    },
    /// The study wants an estimate from a trace that was not given.
    #[error("design.inertia_from is \"trace\": the trace's estimate is missing")]
    NoEstimate,
}
