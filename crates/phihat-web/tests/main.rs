//! Tasks of a page and their answers, on this machine.
#![allow(clippy::unwrap_used, reason = "in a test a panic is the report")]

mod bad;
mod begin;
mod form;
mod happens;
mod same;
mod support;
