//! All integration tests of this crate in one program, which is linked once.
#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

mod audited;
mod class_of_motions;
mod classes;
mod forged;
mod identified;
mod ranges;
mod ranges_proved;
