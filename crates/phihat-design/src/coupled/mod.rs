//! Coupled gains: how far a push on one joint moves every joint, at frozen postures.
//!
//! [`FindCoupledGains::find`] sums impulse responses of the whole arm's loop, at [`Postures`] that are looked for.

pub(crate) mod abreast;
mod at_posture;
mod find;
pub(crate) mod linear;
mod of_study;
mod postures;
mod search;

pub use find::FindCoupledGains;
pub use of_study::coupled;
pub use postures::Postures;
