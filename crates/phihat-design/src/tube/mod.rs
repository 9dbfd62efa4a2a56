//! The tube: an envelope of `e`, `ė` from the start of a run, which no run in scope leaves.
//!
//! See `docs/theory/tube.md`. [`find`] simulates the study's loop with the middle of every interval, makes
//! the loop linear around that run, and finds bounds on the deviation `ε` that one evaluation of the causal sums
//! confirms.
//!
//! From below: `scene` is what a study says; `nominal` the run in the middle, `linear` and `intervals` the
//! loop around it; `deviation`, `kernel`, `segments` and `shapes` what that loop makes of torques, readings
//! and the payload; `tensors` and `moved` what it lacks; `sweep` the bounds, bin by bin; `sliced` all of it
//! for a slice of the payload, `slices` for the whole.
//!
//! # Not claimed
//!
//! Properties that the linear loop lacks: [`TubeRefusal::Unsupported`] names one, and there is no tube.

mod along;
mod basis;
mod controller;
mod desired;
mod deviation;
mod document;
mod envelope;
mod group;
mod intervals;
mod kernel;
mod linear;
mod moved;
mod nominal;
mod products;
mod refusal;
mod relative;
mod scene;
mod segments;
mod shapes;
mod sliced;
mod slices;
mod sweep;
mod tensors;
mod tip;
mod twist;
mod within;

pub use desired::Desired;
pub use document::{tube, tube_in_parts, tube_of_heaviest, tubes_behind};
pub use envelope::{Envelope, JointEnvelope};
pub use refusal::TubeRefusal;
pub use scene::modelled;
pub use slices::{FINER, PARTS, find, find_behind};
pub use tip::tip_along;
