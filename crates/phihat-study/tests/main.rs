//! All integration tests of this crate in one program, which is linked once.
#![allow(clippy::panic, clippy::unwrap_used, reason = "tests: a panic is the report")]

mod support;

mod faults;
mod hostile;
mod numeric;
mod per_joint;
mod published;
mod refused;
mod renamed;
mod samples;
mod studies;
mod supervisor;
mod units;
