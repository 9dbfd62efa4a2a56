//! A description of any format, before it is known which part of it is the arm; and the arm cut out of it.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::Model;
use crate::joint::Joint;

mod chains;
mod cut;
mod matter;
mod named;
mod part;
mod tree;

pub(crate) use matter::checked_matter;
pub(crate) use named::{NamedElement, Result};
pub(crate) use tree::{JointElement, LinkElement, Moves, StatedJoint};

/// Most links, and most joints: far more than any robot has.
pub(crate) const LINKS_MAX: usize = 4096;

/// Links and joints of a file.
pub(crate) struct DescribedFile {
    /// The robot's name.
    pub(crate) name: String,
    /// File, or words that stand for it, in errors.
    pub(crate) origin: String,
    /// Files that it includes.
    pub(crate) included: Vec<PathBuf>,
    pub(crate) links: Vec<LinkElement>,
    pub(crate) joints: Vec<JointElement>,
    /// Element by which the format says that a joint follows another.
    pub(crate) follows: &'static str,
    /// Free acceleration in the world \[m/s²\], where the format states it.
    pub(crate) gravity: Option<[f64; 3]>,
    /// Postures by name: the position of each joint by its name \[rad, m\].
    pub(crate) poses: BTreeMap<String, BTreeMap<String, f64>>,
    /// Oddities of what was read.
    pub(crate) warnings: Vec<String>,
    /// Notes on how something is read that is not written as the format has it.
    pub(crate) notes: Vec<String>,
}

/// An arm that was cut out of a file.
pub(crate) struct CutArm {
    pub(crate) name: String,
    pub(crate) included: Vec<PathBuf>,
    pub(crate) model: Model,
    pub(crate) joints: Vec<Joint>,
    /// Positions of joints that move but are none of the arm's \[rad, m\].
    pub(crate) held: BTreeMap<String, f64>,
    /// Link that the part's tip is; `None`: none is stated.
    pub(crate) tip: Option<String>,
    pub(crate) poses: BTreeMap<String, Vec<f64>>,
    pub(crate) warnings: Vec<String>,
}
