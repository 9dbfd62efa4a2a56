//! Stability of an arm whose joints bend: the clause of elastic joints, as data, and its check.

mod cells;
mod check;
mod derive;
mod disc;
mod document;
mod port;

pub use document::{ElasticJoint, ElasticJoints, EncoderSide};
