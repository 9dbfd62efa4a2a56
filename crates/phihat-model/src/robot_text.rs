//! The text of a robot's file.

use std::io::ErrorKind;
use std::path::Path;

use crate::error::RobotError;
use crate::named_texts::NamedTexts;
use crate::urdf::BYTES_MAX;

/// The text of a robot's file.
pub(crate) fn read_text(files: &NamedTexts, path: &Path) -> Result<String, RobotError> {
    let (origin, limit) = (path.display().to_string(), BYTES_MAX);
    let read = files.text(path, limit as u64);
    // Binary and packed USD are no text.
    let is_usd = match &read {
        Ok(text) => text.starts_with("#usda"),
        Err(_) => usd_extension(path),
    };
    if is_usd && files.is_file(path) {
        let why = "this is USD, which is not read: phihat reads URDF and MJCF; Isaac Sim's URDF exporter \
                   (isaacsim.asset.exporter.urdf) writes one, or take the URDF that the stage was imported from";
        return Err(RobotError::Xml { origin, line: 1, why: why.to_owned() });
    }
    read.map_err(|source| match source.kind() {
        ErrorKind::FileTooLarge => {
            RobotError::TooMuch { origin, what: "bytes", found: limit + 1, limit }
        }
        _ => RobotError::Read { origin, source },
    })
}

/// Returns true if a file's name says that it is USD.
fn usd_extension(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    ["usd", "usda", "usdc", "usdz"].iter().any(|usd| extension.eq_ignore_ascii_case(usd))
}
