//! All integration tests of this crate in one program, which is linked once.
#![allow(clippy::panic, clippy::unwrap_used, reason = "tests: a panic is the report")]

#[path = "../../phihat-report/tests/support/hostile.rs"]
mod hostile;
mod support;

mod agreement;
mod arm;
mod figures;
mod own;
mod page;
mod reach;
mod table3;
mod theory;
