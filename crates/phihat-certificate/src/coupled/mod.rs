//! Coupled gains: how far a push on one joint moves every joint, at frozen postures; their check by a second method.
//!
//! [`CoupledGains::verify`] plays the loop itself, joint by joint and sample by sample, at the postures that
//! are stored in the document.

mod check;
mod document;
pub(crate) mod played;

pub(crate) use check::inverse;
pub use document::{CoupledGains, FrozenPayload, FrozenPosture};
