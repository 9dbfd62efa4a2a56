//! The state that a robot sends, once per cycle.

use crate::error::FciError;
use crate::fault::{COUNT, Faults};
use crate::numbers::{at, put, single};
use crate::protocol::{
    JOINTS, POSE, POSITION, POSITION_TOLD, Protocol, ROTOR_POSITION, ROTOR_VELOCITY, STATE_MOST,
    TORQUE, TORQUE_TOLD, VELOCITY, VELOCITY_TOLD,
};

/// Mode of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum RobotMode {
    /// None of the others.
    Other = 0,
    /// Ready.
    Idle = 1,
    /// In a motion that was requested.
    Move = 2,
    /// Led by hand.
    Guiding = 3,
    /// Stopped by itself: needs recovery.
    Reflex = 4,
    /// Stopped by a person.
    UserStopped = 5,
    /// Recovering.
    Recovery = 6,
}

const MODES: [RobotMode; 7] = [
    RobotMode::Other,
    RobotMode::Idle,
    RobotMode::Move,
    RobotMode::Guiding,
    RobotMode::Reflex,
    RobotMode::UserStopped,
    RobotMode::Recovery,
];

/// Controllers of a state: torques from outside, and none.
pub(crate) const EXTERNAL: u8 = 2;
pub(crate) const NO_CONTROLLER: u8 = 3;

/// A state, as far as torque control needs it.
///
/// Numbers of protocol 10 come in single precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotState {
    /// Number of the message: one more per cycle of 1 ms. It is the robot's clock.
    pub id: u64,
    /// Positions \[rad\].
    pub q: [f64; JOINTS],
    /// Velocities \[rad/s\].
    pub dq: [f64; JOINTS],
    /// Measured torques \[N·m\], gravity among them.
    pub tau_j: [f64; JOINTS],
    /// The torques accepted last \[N·m\], without what the robot adds.
    pub tau_j_d: [f64; JOINTS],
    /// Motion generator: 0 none, else one more than the requested one.
    pub generator: u8,
    /// Controller: 2 external torques, 3 none of the client's.
    pub controller: u8,
    /// Mode of the robot.
    pub mode: RobotMode,
    /// Present errors.
    pub errors: Faults,
    /// Faults that ended the last motion.
    pub reflex_reason: Faults,
    /// Share of the last 100 cycles that had a command.
    pub success_rate: f64,
}

impl RobotState {
    /// Returns true if external torques act.
    #[must_use]
    pub fn takes_torque(&self) -> bool {
        self.mode == RobotMode::Move && self.controller == EXTERNAL
    }

    /// Returns true if no motion of a client runs.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.generator == 0 && self.controller != EXTERNAL
    }

    /// Reads a state.
    ///
    /// # Errors
    ///
    /// [`FciError::Message`]: another length than the protocol's, or a mode that there is not.
    pub fn read(protocol: Protocol, bytes: &[u8]) -> Result<Self, FciError> {
        let wrong = || {
            let valid = format!("{} bytes", protocol.state_bytes());
            FciError::message("a state with a length", bytes.len(), valid)
        };
        if bytes.len() != protocol.state_bytes() {
            return Err(wrong());
        }
        let numbers = |place| numbers(protocol, bytes, place).ok_or_else(wrong);
        let tail = protocol.tail();
        let byte = |place| at::<1>(bytes, place).map(|[byte]| byte).ok_or_else(wrong);
        let faults = |place| at::<COUNT>(bytes, place).ok_or_else(wrong);
        let mode = byte(tail + 84)?;
        let rate = tail + 85;
        let rate = match protocol {
            Protocol::V5 => at(bytes, rate).map(f64::from_le_bytes),
            Protocol::V10 => at(bytes, rate).map(f32::from_le_bytes).map(f64::from),
        };
        Ok(Self {
            id: at(bytes, 0).map(u64::from_le_bytes).ok_or_else(wrong)?,
            q: numbers(POSITION)?,
            dq: numbers(VELOCITY)?,
            tau_j: numbers(TORQUE)?,
            tau_j_d: numbers(TORQUE_TOLD)?,
            generator: byte(tail)?,
            controller: byte(tail + 1)?,
            mode: MODES
                .get(usize::from(mode))
                .copied()
                .ok_or_else(|| FciError::message("a state with a mode", mode.into(), "0 … 6"))?,
            errors: Faults::read(&faults(tail + 2)?),
            reflex_reason: Faults::read(&faults(tail + 43)?),
            success_rate: rate.ok_or_else(wrong)?,
        })
    }
}

fn numbers(protocol: Protocol, bytes: &[u8], place: usize) -> Option<[f64; JOINTS]> {
    let mut all = [0.0; JOINTS];
    for (i, number) in all.iter_mut().enumerate() {
        let place = 8 + protocol.width() * (place + i);
        *number = match protocol {
            Protocol::V5 => f64::from_le_bytes(at(bytes, place)?),
            Protocol::V10 => f32::from_le_bytes(at(bytes, place)?).into(),
        };
    }
    Some(all)
}

/// Measurements of a robot, as they are sent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StateSensed {
    /// Positions \[rad\].
    pub q: [f64; JOINTS],
    /// Velocities \[rad/s\].
    pub dq: [f64; JOINTS],
    /// Measured torques \[N·m\], gravity among them.
    pub tau_j: [f64; JOINTS],
    /// The torques that act on behalf of the client \[N·m\], without what the robot adds.
    pub tau_j_d: [f64; JOINTS],
    /// Pose of the hand in the base's frame, column by column \[1, m\].
    pub pose: [f64; 16],
    /// True if this message reaches the client; if not, nothing is sent in this cycle.
    pub arrives: bool,
}

/// A pose that is none: no turn, no way.
pub const NO_POSE: [f64; 16] =
    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

impl Default for StateSensed {
    fn default() -> Self {
        let none = [0.0; JOINTS];
        Self { q: none, dq: none, tau_j: none, tau_j_d: none, pose: NO_POSE, arrives: true }
    }
}

/// Fields of a state in addition to the measurements.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Said {
    pub(crate) id: u64,
    pub(crate) generator: u8,
    pub(crate) controller: u8,
    pub(crate) mode: RobotMode,
    pub(crate) errors: Faults,
    pub(crate) reflex_reason: Faults,
    pub(crate) success_rate: f64,
}

/// The bytes of a state, laid out once and filled in each cycle.
#[derive(Debug)]
pub(crate) struct StateBytes {
    protocol: Protocol,
    bytes: Box<[u8]>,
}

impl StateBytes {
    /// Frames that are nobody's are the same frame.
    pub(crate) fn new(protocol: Protocol) -> Self {
        let bytes = vec![0; STATE_MOST.min(protocol.state_bytes())].into_boxed_slice();
        let mut new = Self { protocol, bytes };
        for frame in 0..6 {
            new.numbers(POSE + 16 * frame, &NO_POSE);
        }
        new
    }

    fn numbers(&mut self, place: usize, numbers: &[f64]) {
        for (i, number) in numbers.iter().enumerate() {
            let place = 8 + self.protocol.width() * (place + i);
            match self.protocol {
                Protocol::V5 => put(&mut self.bytes, place, &number.to_le_bytes()),
                Protocol::V10 => put(&mut self.bytes, place, &single(*number).to_le_bytes()),
            }
        }
    }

    /// The message of this cycle.
    pub(crate) fn fill(&mut self, sensed: &StateSensed, said: &Said) -> &[u8] {
        put(&mut self.bytes, 0, &said.id.to_le_bytes());
        // The pose is the desired one too: a client that sends torques requests no pose.
        self.numbers(POSE, &sensed.pose);
        self.numbers(POSE + 16, &sensed.pose);
        self.numbers(TORQUE, &sensed.tau_j);
        self.numbers(TORQUE_TOLD, &sensed.tau_j_d);
        for place in [POSITION, POSITION_TOLD, ROTOR_POSITION] {
            self.numbers(place, &sensed.q);
        }
        for place in [VELOCITY, VELOCITY_TOLD, ROTOR_VELOCITY] {
            self.numbers(place, &sensed.dq);
        }
        let tail = self.protocol.tail();
        put(&mut self.bytes, tail, &[said.generator, said.controller]);
        put(&mut self.bytes, tail + 2, &said.errors.write());
        put(&mut self.bytes, tail + 43, &said.reflex_reason.write());
        put(&mut self.bytes, tail + 84, &[said.mode as u8]);
        let rate = said.success_rate;
        match self.protocol {
            Protocol::V5 => put(&mut self.bytes, tail + 85, &rate.to_le_bytes()),
            Protocol::V10 => put(&mut self.bytes, tail + 85, &single(rate).to_le_bytes()),
        }
        &self.bytes
    }
}
