//! A law from positions for each joint: the least torque noise that keeps the joint's error, joint by joint.
//!
//! From below: `family` is the set of laws, `response` what one does at one inertia, `task` the requests of a
//! joint and the cost of a law, `simplex` the search, `search` all joints and the nominal inertia that they
//! share.

mod evolution;
mod family;
mod response;
mod search;
mod simplex;
mod task;

pub(crate) use response::worst_kick;
pub(crate) use search::search;
pub use search::{PositionEstimate, PositionSearch, TubeParts};
