//! All integration tests of this crate in one program, which is linked once.
#![allow(
    clippy::panic,
    clippy::print_stderr,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

#[path = "support/arm.rs"]
mod arm;
#[path = "support/edits.rs"]
mod edits;
#[path = "support/loops.rs"]
mod loops;
#[path = "support/moving_laws.rs"]
mod moving_laws;
mod support;
#[path = "support/two_mass.rs"]
mod two_mass;

mod continuous;
mod documents;
mod elastic;
mod exact;
mod forged_leaves;
mod forgeries;
mod old_names;
mod positions;
mod range;
mod second_method;
mod small;
mod tight;
mod tube;
mod tube_agrees;
mod tube_document;
