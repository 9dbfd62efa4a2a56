//! Inertia that changes at a bounded rate: stability of the coupled arm while it moves.

mod arcs;
mod check;
mod document;

pub use document::{Moving, Unstable};
