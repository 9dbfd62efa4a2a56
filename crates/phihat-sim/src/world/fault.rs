//! Place in the world at which each kind of fault acts.

use phihat_study::FaultKind;

/// Place of action of a fault. Faults at a place are matched there to the last kind, so that a new kind of
/// fault does not compile before its effect is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Acts {
    /// On the torque of a drive.
    Drive(DriveFault),
    /// On a joint's friction.
    Friction(FrictionFault),
    /// As an external torque.
    Push,
    /// As a mass at the tip.
    Payload,
    /// On what one joint's sensor reads.
    Reading(ReadingFault),
    /// On a whole message of measurements.
    Message(MessageFault),
    /// On the way from the sensors.
    SampleLoss,
    /// On the way to the drives.
    CommandLoss,
    /// On the controller itself.
    Controller,
}

/// Fault of a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DriveFault {
    Gain,
    Limit,
}

/// Fault of a joint's friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FrictionFault {
    Times,
    Brake,
}

/// Fault of a sensor's reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ReadingFault {
    Bias,
    Noise,
    Torque,
}

/// Fault of a message of measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MessageFault {
    Freeze,
    Nan,
    JointOrder,
    ClockJump,
}

impl Acts {
    /// The place of a kind.
    pub(super) fn of(kind: FaultKind) -> Self {
        match kind {
            FaultKind::DriveGain => Self::Drive(DriveFault::Gain),
            FaultKind::DriveLimit => Self::Drive(DriveFault::Limit),
            FaultKind::Friction => Self::Friction(FrictionFault::Times),
            FaultKind::Brake => Self::Friction(FrictionFault::Brake),
            FaultKind::Push => Self::Push,
            FaultKind::Payload => Self::Payload,
            FaultKind::SensorBias => Self::Reading(ReadingFault::Bias),
            FaultKind::SensorNoise => Self::Reading(ReadingFault::Noise),
            FaultKind::TorqueBias => Self::Reading(ReadingFault::Torque),
            FaultKind::SensorFreeze => Self::Message(MessageFault::Freeze),
            FaultKind::SensorNan => Self::Message(MessageFault::Nan),
            FaultKind::JointOrder => Self::Message(MessageFault::JointOrder),
            FaultKind::ClockJump => Self::Message(MessageFault::ClockJump),
            FaultKind::SampleLoss => Self::SampleLoss,
            FaultKind::CommandLoss => Self::CommandLoss,
            FaultKind::ControllerStop => Self::Controller,
        }
    }
}
