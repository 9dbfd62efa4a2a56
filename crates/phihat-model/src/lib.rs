#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! Robot description and rigid-body dynamics: allocation-free, generic over the scalar.
//!
//! A [`Robot`] is what its files say: a URDF or an MJCF, told by the root element, and a TOML file for what that leaves
//! out (rotors, friction, limits, encoders, postures). Its [`Model`] computes
//!
//! ```text
//! M(q) q̈ + C(q, q̇) q̇ + g(q) = τ                                                       (1)
//! ```
//!
//! in all directions: torques from motion, motion from torques, the terms one by one, and the
//! geometry that goes with them. Four arms come with the crate.
//!
//! # Guarantee
//!
//! - Every algorithm agrees with Pinocchio 4.1.0 to 1e-12 relative on 200 states of each arm
//! (`tests/pinocchio.rs`). Of MJCF, mass matrix and bias are MuJoCo 4.0's to 1e-9 relative on random files
//! that use what is read (`crates/phihat-py/tests/test_mjcf.py`).
//! - The dynamics do not allocate (`tests/no_allocation.rs`), branch on no value (but for angles
//!   beyond 1e5 rad), and use only `+ − × ÷` and sines from this crate, never fused: by construction
//!   the same bits on every machine.
//! - A description is read only if it is one tree of physical bodies; what is wrong is said with
//!   file, line and name. Hostile files cost no more than their size (`tests/bad_urdf.rs`).
//!
//! # Where next
//!
//! [`Robot`] for descriptions, [`Model`] for all that is computed, [`Model::inverse_kinematics`],
//! [`Robot::inertia_range`] for what a constant nominal inertia has to cover.
#![forbid(unsafe_code)]
#![allow(clippy::inline_always, reason = "the recursions are one loop body each; measured")]

mod arm_file;
mod as_urdf;
mod body;
mod choice;
mod columns;
mod compile;
mod description;
mod energy;
mod error;
mod estimate;
mod evenly;
mod extras;
mod forward_dynamics;
mod four;
mod inertia;
mod inertia_range;
pub mod input;
mod inverse_dynamics;
mod inverse_kinematics;
mod joint;
mod kinematics;
mod known;
mod lanes;
mod lockstep;
mod look;
mod markup;
mod mass_matrix;
mod mjcf;
mod model;
mod named_texts;
mod outline;
mod part;
mod placement;
mod profile;
mod regressor;
mod robot;
mod robot_files;
mod robot_text;
mod scalar;
mod segment;
mod shape;
mod source;
mod straight;
mod trig;
mod uncoupled;
mod urdf;
mod vector;
mod whole;
mod workspace;
#[cfg(test)]
mod written;
pub mod xacro;

pub use body::Body;
pub use choice::FileChoice;
pub use error::{ModelError, NotRigid, RobotError};
pub use estimate::{EstimatedInterval, SPEED_ASSUMED, dry_friction, rotor_inertia};
pub use evenly::evenly;
pub use four::Quad;
pub use inertia_range::InertiaRange;
pub use inverse_kinematics::{IkError, IkOptions, PoseTarget};
pub use joint::{Friction, Joint, JointKind, JointSpring, Rotor, Sigmoid};
pub use kinematics::Pose;
pub use known::{KnownArm, Recognition};
pub use lanes::Lanes;
pub use lockstep::{Lockstep, LockstepError};
pub use look::{LinkShape, Look};
pub use model::{FrameId, GRAVITY, Model};
pub use named_texts::NamedTexts;
pub use outline::Outline;
pub use part::{Chain, MotionOnly, Part};
pub use profile::Profile;
pub use robot::Robot;
pub use scalar::{Four, Scalar};
pub use workspace::Workspace;
