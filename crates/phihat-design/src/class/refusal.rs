//! Reasons why there is no bound for a class of motions.

use thiserror::Error;

use phihat_certificate::Refutation;

/// Why no error bound for a class of motions was found.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ClassRefusal {
    /// The study's reference is no class of motions.
    #[error("reference.kind is not \"any\"")]
    NoClass,
    /// The theorem does not cover something in the study.
    #[error("{0} is not covered by the class theorem")]
    Unsupported(String),
    /// The gains are not for this loop.
    #[error("{0}")]
    Gains(String),
    /// A payload cannot be attached.
    #[error("payload: {0}")]
    Payload(String),
    /// The loop is not stable at a posture.
    #[error(transparent)]
    Unstable(#[from] Refutation),
    /// The law has no integrator: a constant torque leaves an error for ever.
    #[error(
        "the law has no integrator: the response of joint {joint} to a constant torque does not fade"
    )]
    NoIntegrator {
        /// Index of the joint, from 1.
        joint: usize,
    },
    /// Inequality (CM5) has no solution: the class is too fast for these gains.
    #[error("the class does not close: {words}")]
    Open {
        /// Spectral radius of `max Θ` over the postures.
        radius: f64,
        /// Effects of which less would close it, by trying.
        words: String,
    },
}

impl ClassRefusal {
    /// A class that does not close over these postures, of which nothing is tried.
    pub(super) fn open(radius: f64) -> Self {
        let words = format!("spectral radius {radius:.3}");
        Self::Open { radius, words }
    }
}
