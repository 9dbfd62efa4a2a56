//! The study file: read, checked with line-accurate errors, and resolved against its robot.
#![forbid(unsafe_code)]

mod study;

pub use study::*;
