//! Where a law's velocity and torque come from.

/// Where the velocity that the law is fed comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum VelocitySource {
    /// The velocity at the sample, measured.
    Measured,
    /// Backward difference of the (quantised) position over one sample period.
    Differenced,
}

/// Which torque the observer form of the law is fed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum TorqueSource {
    /// The torque that acted: mean over the interval just ended, behind the drive.
    #[default]
    Applied,
    /// The torque that the drive was told over that interval.
    Demanded,
}
