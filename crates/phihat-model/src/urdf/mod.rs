//! URDF: pre-scan, parse, check.

mod element;
mod read;
mod scan;
mod travel;

pub(crate) use read::{declared, described, readable};
pub(crate) use scan::{XACRO_ATTRIBUTES_MAX, scanned};

/// Largest description that is read \[bytes\].
pub(crate) const BYTES_MAX: usize = 4 << 20;
