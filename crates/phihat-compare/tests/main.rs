//! All integration tests of this crate in one program, which is linked once.
#![allow(clippy::panic, clippy::unwrap_used, reason = "tests: a panic is the report")]

#[path = "../../phihat-report/tests/support/hostile.rs"]
mod hostile;
#[path = "support/page.rs"]
mod support;

mod compare;
mod fronts;
mod own;
mod page;
mod page_words;
mod rival_in_the_loop;
mod tune;
