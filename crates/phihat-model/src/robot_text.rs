//! The text of a robot's file.

use std::io::ErrorKind;
use std::path::Path;

use crate::error::RobotError;
use crate::input::text;
use crate::urdf::BYTES_MAX;

/// The text of a robot's file.
pub(crate) fn read_text(path: &Path) -> Result<String, RobotError> {
    let (origin, limit) = (path.display().to_string(), BYTES_MAX);
    text(path, limit as u64).map_err(|source| match source.kind() {
        ErrorKind::FileTooLarge => {
            RobotError::TooMuch { origin, what: "bytes", found: limit + 1, limit }
        }
        _ => RobotError::Read { origin, source },
    })
}
