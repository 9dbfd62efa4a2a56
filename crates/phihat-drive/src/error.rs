//! Why a drive does not happen.

use phihat_fci::FciError;
use phihat_model::RobotError;
use phihat_session::SessionError;
use phihat_sim::SimError;
use thiserror::Error;

use crate::finding::SystemError;
use crate::link::LinkFault;
use crate::order::OrderError;
use crate::preflight::Check;

/// Why a drive does not happen, or breaks off without a record.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DriveError {
    /// Study, gains or record.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The study cannot be simulated, or its motion not be computed.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The joints of the link are not those of the study.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// The robot cannot be talked to.
    #[error("{at}: {why}")]
    Robot {
        /// Its link, as on the command line.
        at: String,
        /// Error of the client.
        why: FciError,
    },
    /// The robot's profile cannot be read.
    #[error(transparent)]
    Profile(#[from] RobotError),
    /// The link cannot be started.
    #[error("the link cannot be started: {0}")]
    Start(LinkFault),
    /// This system has no real-time clock.
    #[error(transparent)]
    System(#[from] SystemError),
    /// A check before the start does not pass, and was not accepted.
    #[error("nothing was driven: {}", failed(.0))]
    Refused(Vec<Check>),
    /// The control thread failed, which is a bug.
    #[error("the control thread failed")]
    Control,
}

fn failed(checks: &[Check]) -> String {
    let refused = checks.iter().filter(|check| check.refuses());
    let names: Vec<_> = refused.map(|check| check.name.word()).collect();
    let accept: Vec<_> = names.iter().map(|name| format!("--accept {name}")).collect();
    format!("{} does not pass (to go on in spite of it: {})", names.join(", "), accept.join(" "))
}
