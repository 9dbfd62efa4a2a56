//! Reason why a synthesis cannot begin or go on.

use std::path::{Path, PathBuf};

use phihat_design::claims::Refutation;
use phihat_design::{
    ArmError, ClassRefusal, ContradictionError, DesignError, EstimateError, GainsError,
};
use phihat_sim::{Overload, SimError};
use thiserror::Error;

/// Reason why a synthesis cannot begin or go on. That no gains exist is no error, but an
/// [`Outcome`](phihat_design::Outcome).
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SynthesisError {
    /// The arm's inertia cannot be computed.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A typed value contradicts the robot's own model.
    #[error(transparent)]
    Contradiction(#[from] ContradictionError),
    /// The arm cannot follow its reference, or the loop cannot be simulated.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The motion needs more torque, rate or speed than the drives have.
    #[error(transparent)]
    Overload(Box<Overload>),
    /// A search cannot begin.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// No bound for a class of motions can be computed.
    #[error("reference.kind = \"any\": {0}")]
    Class(#[from] ClassRefusal),
    /// Gains do not fit the study.
    #[error(transparent)]
    Gains(#[from] GainsError),
    /// The loop is unstable at a posture inside the range of inertia.
    #[error("{0}")]
    Refuted(Box<Refutation>),
    /// The inertia cannot be estimated from a recording.
    #[error("{why}")]
    Estimate {
        /// File of the recording.
        file: PathBuf,
        /// Reason.
        why: EstimateError,
    },
    /// The study bases its design on a recording that was not handed over.
    #[error("the recording {} was not read", .0.display())]
    Recording(PathBuf),
    /// A simulation for φ diverged.
    #[error("the simulation for φ diverged at t = {t} s on joint {joint}")]
    Diverged {
        /// Time \[s\].
        t: f64,
        /// Name of the joint.
        joint: String,
    },
    /// The listener to the steps ended it.
    #[error("cancelled")]
    Cancelled,
    /// Simulation and design do not agree on φ.
    #[error(
        "two rounds of simulation and design do not agree on φ: raise design.phi_margin, or use design.phi_from = \
         \"reference\""
    )]
    PhiUnsettled,
}

impl SynthesisError {
    /// File that the error is about, where it is not the study.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Estimate { file, .. } | Self::Recording(file) => Some(file),
            _ => None,
        }
    }
}

impl From<Refutation> for SynthesisError {
    fn from(why: Refutation) -> Self {
        Self::Refuted(Box::new(why))
    }
}

impl From<phihat_design::Contradiction> for SynthesisError {
    fn from(why: phihat_design::Contradiction) -> Self {
        Self::Contradiction(why.into())
    }
}
