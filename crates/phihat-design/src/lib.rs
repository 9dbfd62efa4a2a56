//! From a study's specification to gains.
//!
//! In this version: the gains a study states, as a versioned document. Nothing here claims that they are
//! stable on a given arm.
#![forbid(unsafe_code)]

pub mod claims;
mod gains;
mod request;
pub mod sampled;

pub use gains::{FORMAT, Gains, GainsError, JointRecord, VERSION};
pub use request::requested_gains;
