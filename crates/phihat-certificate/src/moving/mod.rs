//! Inertia that changes at a bounded rate: stability of the coupled arm while it moves.

mod any_speed;
mod check;
mod document;

pub use any_speed::AnySpeed;
pub use document::{Moving, Unstable};
