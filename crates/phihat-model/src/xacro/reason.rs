//! Reasons of a refusal, before their place is known.

use thiserror::Error;

/// Reason of a refusal: a clause without file and line.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{0}")]
pub(super) struct XacroReason(pub(super) String);

/// Outcome of a part that does not know its place.
pub(super) type Reasoned<T> = Result<T, XacroReason>;

impl From<String> for XacroReason {
    fn from(reason: String) -> Self {
        Self(reason)
    }
}

impl From<&str> for XacroReason {
    fn from(reason: &str) -> Self {
        Self(reason.to_owned())
    }
}

/// A reason, as `format!` has a text.
macro_rules! reason {
    ($($words:tt)*) => { $crate::xacro::reason::XacroReason(format!($($words)*)) };
}
pub(super) use reason;
