//! URDF: pre-scan, parse, check.

use std::collections::BTreeMap;

use crate::Model;
use crate::error::RobotError;
use crate::joint::Joint;

mod chains;
mod element;
mod part;
mod read;
mod scan;
mod travel;
mod tree;

pub(crate) use scan::{XACRO_ATTRIBUTES_MAX, scanned};

pub(crate) use read::{chains, declared, joints, read, readable};

/// Largest description that is read \[bytes\].
pub(crate) const BYTES_MAX: usize = 4 << 20;

/// Content of a URDF.
pub(crate) struct Urdf {
    pub(crate) name: String,
    pub(crate) model: Model,
    pub(crate) joints: Vec<Joint>,
    /// Positions of joints that move but are none of the arm's \[rad, m\].
    pub(crate) held: BTreeMap<String, f64>,
    pub(crate) warnings: Vec<String>,
}

pub(crate) type Result<T> = core::result::Result<T, RobotError>;
