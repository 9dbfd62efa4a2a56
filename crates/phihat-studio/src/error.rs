//! Errors of a studio.

use phihat_session::SessionError;
use phihat_sim::SimError;
use thiserror::Error;

/// Why a studio does not open, or does not do what it was asked.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudioError {
    /// The study cannot be run.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The world cannot meet what was asked for.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The port cannot be listened on, or a thread not be begun.
    #[error("cannot listen on port {port}: {why}; --port 0 takes any that is free")]
    Listen {
        /// The port.
        port: u16,
        /// Error that the system reports.
        why: std::io::Error,
    },
    /// The request is refused.
    #[error("{0}")]
    Refused(String),
}

impl StudioError {
    pub(crate) fn refused(why: impl Into<String>) -> Self {
        Self::Refused(why.into())
    }
}
