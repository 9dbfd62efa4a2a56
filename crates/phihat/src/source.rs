//! Sources of the velocity and torque of a law.

/// Source of the velocity that the law uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum VelocitySource {
    /// The velocity at the sample, measured.
    Measured,
    /// Backward difference of the (quantised) position over one sample period.
    Differenced,
}

/// Torque that the observer form of the law uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum TorqueSource {
    /// The torque that acted: mean over the interval just ended, behind the drive.
    #[default]
    Applied,
    /// The torque that was commanded to the drive over that interval.
    Demanded,
}
