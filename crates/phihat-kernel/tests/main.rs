//! All integration tests of this crate in one program, which is linked once.
#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

mod claims;
mod loops;
mod numbers;
mod random;
