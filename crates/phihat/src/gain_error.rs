//! Why a design is refused, and which gain is to blame.

use core::fmt;

use crate::delay::PENDING_MAX;
use crate::{ORDER_MAX, SECTIONS_MAX};

/// Names a gain in an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Gain {
    /// `M̄`.
    Inertia,
    /// `K_p`.
    Kp,
    /// `K_d`.
    Kd,
    /// `a_i`, with its index.
    A(usize),
    /// The sample period `T`.
    Period,
    /// A torque limit.
    TorqueMax,
    /// A torque-rate limit.
    TorqueRateMax,
    /// The most energy within a time.
    EnergyMax,
    /// The time that it is counted in.
    EnergyWindow,
    /// A velocity limit.
    VelocityMax,
    /// An acceleration limit.
    AccelerationMax,
    /// A jerk limit.
    JerkMax,
    /// The width of the box of a reference.
    BoxWidth,
    /// The bandwidth of a velocity filter.
    VelocityFilter,
    /// The bandwidth of the low-pass on the torque command.
    TorqueFilter,
    /// The share of the way to the wanted torque per sample.
    Share,
    /// `ℓ_i`, with its index.
    Correction(usize),
    /// `λ_i`, with its index.
    VelocityCorrection(usize),
    /// A number of a section of the innovation filter, with its index.
    Section(usize),
}

impl Gain {
    /// `value`, where it is positive and finite.
    pub(crate) fn positive(self, value: f64) -> Result<f64, GainError> {
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(GainError::NotPositive { gain: self, value })
        }
    }

    /// Refuses what is not finite; either sign is possible.
    pub(crate) fn finite(self, value: f64) -> Result<(), GainError> {
        if value.is_finite() { Ok(()) } else { Err(GainError::NotFinite { gain: self, value }) }
    }
}

impl fmt::Display for Gain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Inertia => f.write_str("inertia [kg m^2]"),
            Self::Kp => f.write_str("kp [1/s^2]"),
            Self::Kd => f.write_str("kd [1/s]"),
            Self::A(i) => write!(f, "a[{i}]"),
            Self::Period => f.write_str("period [s]"),
            Self::TorqueMax => f.write_str("torque limit [N m]"),
            Self::TorqueRateMax => f.write_str("torque-rate limit [N m/s]"),
            Self::EnergyMax => f.write_str("energy limit [J]"),
            Self::EnergyWindow => f.write_str("time of the energy limit [s]"),
            Self::VelocityMax => f.write_str("velocity limit [rad/s]"),
            Self::AccelerationMax => f.write_str("acceleration limit [rad/s^2]"),
            Self::JerkMax => f.write_str("jerk limit [rad/s^3]"),
            Self::BoxWidth => f.write_str("width of the box [rad]"),
            Self::VelocityFilter => f.write_str("velocity filter [Hz]"),
            Self::TorqueFilter => f.write_str("torque filter [Hz]"),
            Self::Share => f.write_str("share"),
            Self::Correction(i) => write!(f, "correction[{i}]"),
            Self::VelocityCorrection(i) => write!(f, "velocity_correction[{i}]"),
            Self::Section(i) => write!(f, "section {i} of the innovation filter"),
        }
    }
}

/// Why a design is refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum GainError {
    /// A gain is zero, negative, infinite or NaN.
    NotPositive {
        /// The gain.
        gain: Gain,
        /// Its value.
        value: f64,
    },
    /// A gain that may have either sign is infinite or NaN.
    NotFinite {
        /// The gain.
        gain: Gain,
        /// Its value.
        value: f64,
    },
    /// The number of coefficients is not 1 … 4.
    Order {
        /// Number of coefficients.
        order: usize,
    },
    /// `s^m + a_{m−1} s^{m−1} + … + a_0` has a root with a non-negative real part.
    UnstableEstimator {
        /// Its order.
        order: usize,
    },
    /// A law from positions is designed as a [`PositionDesign`](crate::PositionDesign).
    Form,
    /// More than the whole way to the wanted torque in one sample.
    Share {
        /// The share.
        value: f64,
    },
    /// A delay across which a law from positions does not predict.
    Delay {
        /// Samples of it.
        samples: usize,
    },
    /// Corrections whose number does not fit an observer.
    Corrections {
        /// Number of corrections by the position.
        position: usize,
        /// Number of corrections by the velocity.
        velocity: usize,
    },
    /// An innovation filter has one section or two.
    Sections {
        /// Number of sections.
        count: usize,
    },
    /// A section of the innovation filter does not settle.
    UnstableSection {
        /// Index of the section.
        index: usize,
    },
    /// Gains so large, or an inertia or a period so small, that torques would overflow in the running scalar.
    Overflow,
}

impl fmt::Display for GainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositive { gain, value } => {
                write!(f, "{gain} is {value}; it must be positive and finite")
            }
            Self::NotFinite { gain, value } => write!(f, "{gain} is {value}; it must be finite"),
            Self::Order { order } => {
                write!(f, "the estimator has {order} coefficients; 1 to {ORDER_MAX} are possible")
            }
            Self::UnstableEstimator { order } => write!(
                f,
                "the estimator of order {order} is not stable (Routh, Schur); lower its low coefficients"
            ),
            Self::Form => f.write_str("a law from positions has a design of its own, with an observer in place of `a`"),
            Self::Share { value } => write!(f, "share is {value}; it must be above 0 and at most 1"),
            Self::Delay { samples } => {
                write!(f, "a delay of {samples} samples; at most {PENDING_MAX} are possible")
            }
            Self::Corrections { position, velocity } => write!(
                f,
                "{position} corrections by position and {velocity} by velocity; 3 to 5, and none or as many, are \
                    possible"
            ),
            Self::Sections { count } => {
                write!(f, "{count} sections of an innovation filter; 1 to {SECTIONS_MAX} are possible")
            }
            Self::UnstableSection { index } => write!(
                f,
                "section {index} of the innovation filter is not stable: 0 < c_0 < c_1 and 2 c_1 < 4 + c_0 are possible"
            ),
            Self::Overflow => f.write_str(
                "gains, inertia and period are too far from 1: torques would overflow in this scalar",
            ),
        }
    }
}

impl core::error::Error for GainError {}
