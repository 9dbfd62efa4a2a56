//! All integration tests of this crate in one program, which is linked once.

mod support;

mod faults;
mod hostile;
mod per_joint;
mod published;
mod refused;
mod samples;
mod studies;
mod supervisor;
mod units;
