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
    #[error(
        "the class does not close: spectral radius {radius:.3} is not below 1; slower motion or stiffer gains"
    )]
    Open {
        /// Spectral radius of `max Θ` over the postures.
        radius: f64,
    },
    /// The same for lost commands: what a row of losses does to the commands is lost again with the next one.
    #[error(
        "lost commands do not close: a change of the command adds {radius:.3} of itself to others, not below 1; softer \
         gains, or fewer commands lost in a row (world.network.commands_lost_max)"
    )]
    Losses {
        /// Spectral radius of `Γ^L` for the change of the command.
        radius: f64,
    },
}
