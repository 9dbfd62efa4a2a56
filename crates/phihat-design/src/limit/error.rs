//! Why there is no limit to tell.

use thiserror::Error;

/// Why a limit cannot be enclosed.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LimitError {
    /// A number is not one of its kind.
    #[error("{name} is {value}: it has to be {needs}")]
    Number {
        /// Field of the request.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Condition on the value.
        needs: &'static str,
    },
    /// The torque comes too late.
    #[error("delay is {delay} samples: at most {max} are looked at")]
    Delay {
        /// Delay asked for \[samples\].
        delay: usize,
        /// Longest delay \[samples\].
        max: usize,
    },
    /// Nothing acts on the joint.
    #[error(
        "phi_rate and phi_jump are both 0: where nothing acts the slower law is the better one, and none is the best"
    )]
    NoPhi,
    /// The numbers leave the range of double precision.
    #[error(
        "the numbers of this joint are too far apart: check the units of inertia, quantum and torque_change_max"
    )]
    Scale,
    /// The loop has what the limit leaves out.
    #[error("it does not cover {what}")]
    NotCovered {
        /// Property that it does not cover.
        what: &'static str,
    },
    /// The law that is set beside the limit does not hold.
    #[error("the law is not stable at μ = {mu}, or a constant φ leaves an error there")]
    Unstable {
        /// Inertia over `M̄`.
        mu: f64,
    },
    /// No law of this length keeps the torque's change.
    #[error(
        "no law whose response ends within {length} samples was found that changes the torque by no more than \
         torque_change_max; the error of any law is at least {low_rad:e} rad"
    )]
    NoLaw {
        /// Longest response that was tried \[samples\].
        length: usize,
        /// Lower bound on the error of any law \[rad\].
        low_rad: f64,
    },
}
