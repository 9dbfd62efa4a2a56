#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! The arm under control, live, in a browser: `phihat studio`.
//!
//! [`Live`] is a run that goes on sample by sample and meets faults as they come; while none comes, its rows are
//! those of `phihat run`, bit for bit. [`Studio`] serves it to pages of this machine: a thread runs in real time,
//! pages get pictures of it and give orders that act between two samples, and the claims of their gains are
//! computed alongside.
//!
//! # Who is let in
//!
//! Connections of this machine, with the key that was printed, from no page of another origin. Nothing is read or
//! written outside of the working folder. Connections, sizes, rates and times are bounded; `tests/attacks.rs` is
//! the list of what was tried against that.
#![forbid(unsafe_code)]

mod begin;
mod beside;
mod error;
mod folder;
mod gate;
mod live;
mod numbers;
mod offer;
mod open;
mod player;
mod proof;
mod recorded;
mod routes;
mod sampled;
mod stage;
mod state;
mod studio;
mod text;
mod wire;

pub use begin::Begin;
pub use beside::AlongsideLaw;
pub use error::StudioError;
pub use live::Live;
pub use studio::{Studio, StudioOptions};
