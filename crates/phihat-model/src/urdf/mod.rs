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

pub(crate) use read::{chains, read, readable};

/// Largest description that is read \[bytes\].
pub(crate) const BYTES_MAX: usize = 4 << 20;

/// What a URDF says.
pub(crate) struct Urdf {
    pub(crate) name: String,
    pub(crate) model: Model,
    pub(crate) joints: Vec<Joint>,
    /// Where what moves but is none of the arm's stands \[rad, m\].
    pub(crate) held: BTreeMap<String, f64>,
    pub(crate) warnings: Vec<String>,
}

pub(crate) type Result<T> = core::result::Result<T, RobotError>;
