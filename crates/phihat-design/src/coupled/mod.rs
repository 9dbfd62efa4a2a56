//! Coupled gains: how far a push on one joint moves every joint, at frozen postures.
//!
//! [`CoupledGains::find`] sums impulse responses of the whole arm's loop; [`CoupledGains::verify`] plays the loop itself, joint
//! by joint and sample by sample, at the postures that the document keeps, and sees nothing of how the figures were found.

mod alpha;
mod at_posture;
mod check;
mod document;
mod find;
mod linear;
mod played;
mod postures;
mod search;

pub use document::{CoupledGains, FrozenPayload, FrozenPosture};
pub use postures::Postures;
