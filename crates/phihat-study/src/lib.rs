#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! The study file: read, checked with line-accurate errors, and resolved against its robot.
//!
//! A study says which arm, what error its user can live with, which gains, what the world does to
//! it, and what it shall do. [`Study::read`] gives all of it as checked plain data in SI units, or
//! the one [`StudyError`] that says where the file is wrong and what would be right.
//!
//! Nothing in a [`Study`] needs a second check: numbers are finite and in range, every per-joint
//! value has one entry per joint in the robot's order, names are known, references keep the joints'
//! position limits (a Cartesian curve excepted: its reach is known to inverse kinematics only).
//!
//! The format is described once, in tables; [`manual`] and [`schema`] are made from them.
//!
//! # Where next
//!
//! [`Study`] with all its parts, [`manual`] for every key, the folder `studies/` of the repository for complete files.
#![forbid(unsafe_code)]

mod arm;
mod base;
mod cartesian;
mod check;
mod contact;
mod control;
mod design;
mod design_keys;
mod entries;
mod error;
mod fault;
mod feedforward;
mod format;
mod found;
mod gains;
mod joint;
mod key_parts;
mod keys;
mod limits;
mod manual;
mod node;
mod numeric;
mod payload;
mod payload_set;
mod per_joint;
mod profile;
mod read;
mod reference;
mod reference_keys;
mod renamed;
mod rewritten;
mod robot_value;
mod run;
mod samples;
mod schema;
mod sines;
mod source;
mod spec;
mod springs;
mod study;
mod suggest;
mod supervisor;
mod supervisor_keys;
mod value;
mod world;
mod world_keys;

pub use contact::{AfterContact, ContactRequest};
pub use control::AHEAD_MAX;
pub use error::{StudyError, StudyErrorKind};
pub use fault::{Fault, FaultKind};
pub use joint::JOINT_BY_JOINT;
pub use manual::manual;
pub use numeric::NumericKey;
pub use payload::Payload;
pub use payload_set::PayloadSet;
pub use renamed::RenamedKey;
pub use samples::{Samples, motion_samples};
pub use schema::schema;
pub use springs::JointSprings;
pub use study::*;
pub use supervisor::{RequestedMode, SupervisorRequest, requested};
