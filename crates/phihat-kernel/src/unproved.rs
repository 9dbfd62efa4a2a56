//! The answer where a claim is not proved.

use core::fmt;

/// Reason why a claim is not proved.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Unproved {
    /// The numbers are no loop: one is not finite, sizes do not fit, or torque meets the inertia in several places.
    NoLoop,
    /// The claim's own numbers make no sense, such as a range whose low end is above its high end.
    NoClaim,
    /// A joint alone, at one ratio in the range, has a root that is not inside the circle.
    Unstable {
        /// Index of the joint.
        joint: usize,
    },
    /// The inequality fails, or was not shown, at a frequency.
    At {
        /// Index of the joint; `None`: all joints together.
        joint: Option<usize>,
        /// Frequency \[rad/sample\].
        theta: f64,
    },
}

impl fmt::Display for Unproved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoLoop => write!(f, "the numbers are no loop"),
            Self::NoClaim => write!(f, "the claim's numbers make no sense"),
            Self::Unstable { joint } => write!(f, "joint {joint} alone is not stable"),
            Self::At { joint: Some(joint), theta } => {
                write!(f, "joint {joint} fails at {theta:.6} rad/sample")
            }
            Self::At { joint: None, theta } => write!(f, "it fails at {theta:.6} rad/sample"),
        }
    }
}

impl core::error::Error for Unproved {}
