//! All integration tests of this crate in one program, which is linked once.
#![allow(clippy::panic, clippy::unwrap_used, reason = "tests: a panic is the report")]

mod support;

mod claims;
mod class;
mod drawer;
mod escaping;
mod self_contained;
mod shapes;
mod specimens;
mod verdict;
