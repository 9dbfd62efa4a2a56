//! All integration tests of this crate in one program, which is linked once.
#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests: a panic is the report"
)]

mod support;

mod abreast;
mod accuracy;
mod batch;
mod blocks;
mod cases;
mod contact;
mod driver;
mod error_share;
mod false_alarms;
mod held;
mod imperfections;
mod interface;
mod mcap;
mod mechanics;
mod motion;
mod one_joint;
mod overload;
mod parquet;
mod stops;
mod supervised;
mod trace;
