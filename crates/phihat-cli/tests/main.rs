//! All integration tests of this crate in one program, which is linked once.
#![allow(clippy::panic, clippy::unwrap_used, reason = "tests: a panic is the report")]

mod support;

mod blocks;
mod bound;
mod budget;
mod compare;
mod contact;
mod design;
mod drive;
mod every_verb;
mod export;
mod faults;
mod filter;
mod help_and_errors;
mod hostile_world;
mod identify;
mod killed;
mod known;
mod mistakes;
mod new;
mod panda;
mod records;
mod renamed;
mod reproduce;
mod run;
mod serve;
mod struck;
mod sweep;
mod terminal;
mod texts;
mod tip;
mod tube;
mod verify_study;
mod xacro;
