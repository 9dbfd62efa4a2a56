//! All integration tests of this crate in one program, which is linked once.
#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

mod support;

mod bound;
mod endings;
mod facts;
mod first_motion;
mod franka;
mod links;
mod lying;
mod lying_bytes;
mod no_allocation;
mod parking;
mod referred;
mod same_trace;
