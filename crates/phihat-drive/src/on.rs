//! Names of links on a command line.

use phihat_fci::{Protocol, STATE_WAIT};
use phihat_model::RobotError;
use phihat_study::Study;
use thiserror::Error;

use crate::facts::{Clock, Facts};
use crate::franka::{FrankaAddress, FrankaLink};
use crate::sim::SimLink;

/// The other end of a drive.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum On {
    /// phihat's own world, in lock-step.
    #[default]
    Sim,
    /// The same by this machine's clock.
    SimRealTime,
    /// A Franka.
    Franka(FrankaAddress),
}

impl On {
    /// Parses the name of a link: `sim`, or `fci://HOST` with an optional port and `?protocol=5` or `?protocol=10`.
    ///
    /// # Errors
    ///
    /// [`OnError`]: there is no such link; it says what is valid.
    pub fn of(link: &str, real_time: bool) -> Result<Self, OnError> {
        match (link, link.strip_prefix("fci://"), real_time) {
            ("sim", _, false) => Ok(Self::Sim),
            ("sim", _, true) => Ok(Self::SimRealTime),
            (_, Some(_), true) => Err(OnError::Clock(link.to_owned())),
            (_, Some(place), false) => {
                let none = || OnError::Link(link.to_owned());
                let (host, protocol) = match place.split_once('?') {
                    None => (place, None),
                    Some((host, asked)) => (host, Some(version(asked).ok_or_else(none)?)),
                };
                if host.is_empty() {
                    return Err(none());
                }
                let (host, patience) = (host.to_owned(), STATE_WAIT);
                Ok(Self::Franka(FrankaAddress { host, protocol, patience }))
            }
            _ => Err(OnError::Link(link.to_owned())),
        }
    }

    /// The words for it on a command line.
    pub fn words(&self) -> String {
        match self {
            Self::Sim => "--on sim".to_owned(),
            Self::SimRealTime => "--on sim --real-time".to_owned(),
            Self::Franka(FrankaAddress { host, protocol, .. }) => {
                let asked = protocol.map(|asked| format!("?protocol={}", asked.version()));
                format!("--on fci://{host}{}", asked.unwrap_or_default())
            }
        }
    }

    /// Facts of the link, before it is opened.
    pub(crate) fn facts(&self, study: &Study) -> Result<Facts, RobotError> {
        match self {
            Self::Sim => Ok(SimLink::facts_of(study, Clock::LockStep)),
            Self::SimRealTime => Ok(SimLink::facts_of(study, Clock::Host)),
            Self::Franka(address) => FrankaLink::facts_of(address),
        }
    }
}

/// The version that `protocol=N` asks for.
fn version(asked: &str) -> Option<Protocol> {
    Protocol::of_version(asked.strip_prefix("protocol=")?.parse().ok()?)
}

/// Why there is no such link.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum OnError {
    /// It is none of the links.
    #[error(
        "--on {0}: `sim`, `fci://HOST` or `fci://HOST:PORT` is valid, the latter two with `?protocol=5` or \
            `?protocol=10` behind them"
    )]
    Link(String),
    /// The clock is the robot's.
    #[error("--real-time with --on {0}: the clock is the robot's; leave `--real-time` out")]
    Clock(String),
}
