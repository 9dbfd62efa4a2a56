//! The versions of the interface that are spoken here, and how large their messages are.

/// Joints of the arm: the interface knows no other number.
pub const JOINTS: usize = 7;

/// TCP port that robots listen on.
pub const PORT: u16 = 1337;

/// A version of the interface.
///
/// # Wire layout
///
/// All messages are packed and little-endian. UDP, robot to client: the state, 64-bit number of the message,
/// then numbers (here one after the other), then the tail. UDP, client to robot: the command.
///
/// | | `V5` | `V10` |
/// |---|---|---|
/// | spoken by libfranka | 0.9 | 0.18 and later |
/// | state | 2373 bytes: u64, 284 f64, tail at 2280 | 1377 bytes: u64, 320 f32, tail at 1288 |
/// | tail | u8 generator, u8 controller, 41 u8 errors, 41 u8 reflex reasons, u8 mode, f64 success rate | the same, f32 success rate |
/// | command | 370 bytes: u64, 306 of motion (finish flag at 313), 7 f64 torque at 314 | 371 bytes: the same, finish flag of torque at 370 |
///
/// # References
///
/// `rbk_types.h`, `service_types.h` and `error.h` of libfranka-common (Apache-2.0) for version 5; version 10
/// as official clients send and take it. Versions 6 to 9 are not spoken here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Protocol {
    /// Version 5: libfranka 0.9, the Panda.
    V5,
    /// Version 10: libfranka 0.18 and later, the FR3.
    V10,
}

/// Numbers of a state that are read or written here: the place of the first, counted in numbers.
pub(crate) const POSE: usize = 0;
pub(crate) const TORQUE: usize = 126;
pub(crate) const TORQUE_TOLD: usize = 133;
pub(crate) const POSITION: usize = 147;
pub(crate) const POSITION_TOLD: usize = 154;
pub(crate) const VELOCITY: usize = 161;
pub(crate) const VELOCITY_TOLD: usize = 168;
pub(crate) const ROTOR_POSITION: usize = 270;
pub(crate) const ROTOR_VELOCITY: usize = 277;

/// Bytes of the largest state.
pub(crate) const STATE_MOST: usize = 2373;

/// Bytes of the largest command.
pub(crate) const COMMAND_MOST: usize = 371;

impl Protocol {
    /// All that are spoken here, the oldest first.
    pub const ALL: [Self; 2] = [Self::V5, Self::V10];

    /// The number that stands for it on the wire.
    #[must_use]
    pub const fn version(self) -> u16 {
        match self {
            Self::V5 => 5,
            Self::V10 => 10,
        }
    }

    /// The version of this number, if it is spoken here.
    #[must_use]
    pub fn of_version(version: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|protocol| protocol.version() == version)
    }

    /// Bytes of a state.
    #[must_use]
    pub const fn state_bytes(self) -> usize {
        match self {
            Self::V5 => STATE_MOST,
            Self::V10 => 1377,
        }
    }

    /// Bytes of a command.
    #[must_use]
    pub const fn command_bytes(self) -> usize {
        match self {
            Self::V5 => 370,
            Self::V10 => COMMAND_MOST,
        }
    }

    /// Bytes of one number of a state.
    pub(crate) const fn width(self) -> usize {
        match self {
            Self::V5 => 8,
            Self::V10 => 4,
        }
    }

    /// Offset of the tail of a state \[bytes\].
    pub(crate) const fn tail(self) -> usize {
        match self {
            Self::V5 => 2280,
            Self::V10 => 1288,
        }
    }

    /// The motion generator that a torque control requests in addition to its torque: `None`; in version 5
    /// there is no such word, and libfranka requests joint velocities, which stay zero.
    pub(crate) const fn generator(self) -> u32 {
        match self {
            Self::V5 => 1,
            Self::V10 => 4,
        }
    }
}
