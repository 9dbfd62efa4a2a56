#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! [`synthesize()`] is the algorithm: its body, in `synthesize.rs`, reads from the specification over candidates, their
//! tubes and the shares for the next candidates to the certificate.
//!
//! # The way through the code
//!
//! 1. `synthesize.rs`: the algorithm.
//! 2. `candidates.rs`: one law per joint, for bounds of `φ` from the study's source.
//! 3. `judged.rs`: the tube of a candidate, and the share of the specification that each joint uses.
//! 4. `spec_search.rs` and `position_search.rs`: the repetition, for laws with velocity and for laws from positions;
//!    `rank.rs` the shares for the next candidates; `class_search.rs` for every motion of a class.
//! 5. `phihat-design`: the finders of laws ([`phihat_design::search`], [`phihat_design::PositionSearch`]) and of tubes
//!    ([`phihat_design::tube`]).
//!
//! # Where next
//!
//! `phihat-session` reads study files and runs the gains; [`budget()`] splits the error by its causes.
#![forbid(unsafe_code)]

mod along;
mod arm;
mod beyond;
mod budget;
mod candidates;
mod class_search;
mod class_study;
mod coarser;
mod commanded;
pub mod digits;
mod error;
mod judged;
mod limits;
mod position_search;
mod rank;
mod recordings;
mod rotor;
mod spec_search;
mod springs;
mod stated;
mod steps;
mod synthesize;
mod tube_of;
mod tube_parts;
mod typed_phi;

pub use along::{arm_along, coupled_along, motion_along, phi_along};
pub use arm::arm;
pub use budget::{BudgetSearch, budget};
pub use error::SynthesisError;
pub use judged::{SETTLED_S, late_error};
pub use limits::beside_limits;
pub use recordings::{Recording, Recordings};
pub use rotor::{any_law, lacking, one_search, smallest_rotor};
pub use steps::Steps;
pub use synthesize::{Advice, SynthesisOptions, synthesize, synthesize_in_steps};
pub use tube_of::{bound_by_tube, tube_of};
pub use tube_parts::filtered_laws;
pub use typed_phi::typed_phi_holds;
