//! All integration tests of this crate in one program, which is linked once.
#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

mod impossible;
mod no_bound_without_tube;
mod sources;
mod stated;
mod torque_filter;
