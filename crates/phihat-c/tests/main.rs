//! All integration tests of this crate in one program, which is linked once.
#![allow(clippy::panic, reason = "tests: a panic is the report")]

mod support;

mod fuzz;
mod gate;
mod header;
mod no_allocation;
mod older_header;
mod positions;
mod refused;
