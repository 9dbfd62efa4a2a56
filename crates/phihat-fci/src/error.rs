//! Why a robot cannot be talked to.

use std::borrow::Cow;
use std::io;
use std::time::Duration;

use thiserror::Error;

use crate::fault::Faults;

/// Why a robot cannot be talked to, or a message not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FciError {
    /// The system's network.
    #[error("{what}: {why}")]
    Network {
        /// Operation that failed.
        what: Cow<'static, str>,
        /// Error of the system.
        why: io::Error,
    },
    /// No state for as long as one may take.
    #[error("the robot sent no state for {} s", .0.as_secs_f64())]
    Silent(Duration),
    /// The robot does not speak the requested version.
    #[error("the robot speaks version {robot} of the interface, asked for was version {asked}")]
    Version {
        /// The robot's.
        robot: u16,
        /// That of this client.
        asked: u16,
    },
    /// The robot refused a request.
    #[error("the robot refused {request} (status {status}){}", shown(.reasons))]
    Refused {
        /// The request's name.
        request: &'static str,
        /// Status of its answer.
        status: u8,
        /// Faults of its last stop.
        reasons: Faults,
    },
    /// The robot ended a motion by itself.
    #[error("the robot ended the motion (status {status}){}", shown(.reasons))]
    Aborted {
        /// Status of its answer.
        status: u8,
        /// Faults that ended the motion.
        reasons: Faults,
    },
    /// A message that is none.
    #[error("{what} of {found}; valid: {valid}")]
    Message {
        /// Name of the message and of its part.
        what: &'static str,
        /// The figure found.
        found: u64,
        /// Valid values.
        valid: String,
    },
    /// The robot did not do what follows by the interface.
    #[error("the robot did not {0} within 1000 states")]
    Stuck(&'static str),
}

impl FciError {
    pub(crate) fn network(what: impl Into<Cow<'static, str>>) -> impl FnOnce(io::Error) -> Self {
        let what = what.into();
        |why| Self::Network { what, why }
    }

    pub(crate) fn message(what: &'static str, found: usize, valid: impl Into<String>) -> Self {
        Self::Message { what, found: found as u64, valid: valid.into() }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "an error's fields are lent")]
fn shown(reasons: &Faults) -> String {
    if reasons.is_empty() { String::new() } else { format!(": {reasons}") }
}
