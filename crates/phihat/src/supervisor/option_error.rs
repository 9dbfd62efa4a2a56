//! Why options are refused.

use core::fmt;

use crate::GainError;

/// Why options are refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum OptionError {
    /// An option is out of its range.
    Value {
        /// Name of the option.
        option: &'static str,
        /// Value of the option.
        value: f64,
        /// Valid values.
        valid: &'static str,
        /// Place of the joint; 0 for options of the whole arm.
        joint: usize,
    },
    /// A joint's gains are for another sample period.
    Period {
        /// Place of the joint.
        joint: usize,
    },
    /// Start gains are of another form of the law than the running gains.
    Form {
        /// Place of the joint.
        joint: usize,
    },
    /// A limit of the reference governor.
    Motion {
        /// Place of the joint.
        joint: usize,
        /// Error of the limit.
        error: GainError,
    },
}

impl fmt::Display for OptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value { option, value, valid, joint } => {
                write!(f, "joint {joint}: {option} is {value}; it must be {valid}")
            }
            Self::Period { joint } => {
                write!(f, "joint {joint}: its gains are for another sample period than the options")
            }
            Self::Form { joint } => {
                write!(f, "joint {joint}: start gains need the form of the running gains")
            }
            Self::Motion { joint, error } => write!(f, "joint {joint}: {error}"),
        }
    }
}

impl core::error::Error for OptionError {}

/// `Ok` if an option is valid.
pub(crate) fn value(
    ok: bool,
    option: &'static str,
    value: f64,
    valid: &'static str,
    joint: usize,
) -> Result<(), OptionError> {
    if ok { Ok(()) } else { Err(OptionError::Value { option, value, valid, joint }) }
}

const POSITIVE: &str = "positive and finite";

/// `Ok` if an option is positive and finite.
pub(crate) fn positive(x: f64, option: &'static str, joint: usize) -> Result<(), OptionError> {
    value(x.is_finite() && x > 0.0, option, x, POSITIVE, joint)
}
