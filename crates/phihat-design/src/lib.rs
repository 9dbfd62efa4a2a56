//! From a study's specification to gains.
#![forbid(unsafe_code)]

mod gains;

pub use gains::{Gains, JointRecord};
