//! The command that a client sends, once per cycle.

use crate::error::FciError;
use crate::numbers::{at, doubles, put};
use crate::protocol::{COMMAND_MOST, JOINTS, Protocol};

const MOTION_FINISHED: usize = 313;
const TORQUE: usize = 314;
const TORQUE_FINISHED: usize = 370;

/// A torque command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotCommand {
    /// Number of the state that it answers.
    pub id: u64,
    /// Torques \[N·m\], without what the robot adds.
    pub tau: [f64; JOINTS],
    /// True if the motion ends with it.
    pub finished: bool,
}

impl RobotCommand {
    /// Reads a command. Motion in addition to the torque is not used.
    ///
    /// # Errors
    ///
    /// [`FciError::Message`]: another length than the protocol's.
    pub fn read(protocol: Protocol, bytes: &[u8]) -> Result<Self, FciError> {
        let wrong = || {
            let valid = format!("{} bytes", protocol.command_bytes());
            FciError::message("a command with a length", bytes.len(), valid)
        };
        Self::parse(protocol, bytes).ok_or_else(wrong)
    }

    pub(crate) fn parse(protocol: Protocol, bytes: &[u8]) -> Option<Self> {
        if bytes.len() != protocol.command_bytes() {
            return None;
        }
        let flag = |place| at::<1>(bytes, place).is_some_and(|[byte]| byte != 0);
        Some(Self {
            id: u64::from_le_bytes(at(bytes, 0)?),
            tau: doubles(bytes, TORQUE)?,
            finished: flag(MOTION_FINISHED) || protocol == Protocol::V10 && flag(TORQUE_FINISHED),
        })
    }

    /// Writes it into a buffer of the largest size; how many bytes it has.
    pub(crate) fn fill(&self, protocol: Protocol, bytes: &mut [u8; COMMAND_MOST]) -> usize {
        put(bytes, 0, &self.id.to_le_bytes());
        for (i, tau) in self.tau.iter().enumerate() {
            put(bytes, TORQUE + 8 * i, &tau.to_le_bytes());
        }
        put(bytes, MOTION_FINISHED, &[u8::from(self.finished)]);
        if protocol == Protocol::V10 {
            put(bytes, TORQUE_FINISHED, &[u8::from(self.finished)]);
        }
        protocol.command_bytes()
    }

    /// Its bytes.
    #[must_use]
    pub fn to_bytes(&self, protocol: Protocol) -> Vec<u8> {
        let mut bytes = [0; COMMAND_MOST];
        let length = self.fill(protocol, &mut bytes);
        bytes.iter().copied().take(length).collect()
    }
}
