//! All integration tests of this crate in one program, which is linked once.
#![allow(clippy::panic, clippy::unwrap_used, reason = "tests: a panic is the report")]

mod support;

mod both_sides;
mod hostile;
mod layout;
mod no_allocation;
mod sessions;
