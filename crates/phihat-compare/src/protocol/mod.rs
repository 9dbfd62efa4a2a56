//! Parts of a comparison in which every law has the same noise to spend: the noise figure, the order of candidates under
//! constraints, and the worlds that are drawn.
//!
//! # Not claimed
//!
//! A comparison: these are its parts. What goes over all laws, caps and restarts, and its page, are not here.

mod assess;
mod feasible;
mod margin;
mod noise;
mod worlds;

pub use assess::{Assessor, PER_SCALAR};
pub use feasible::{Assessed, CAPS, better};
pub use margin::{Harder, LOUDER};
pub use noise::{NOISE_FROM_HZ, noise_above};
pub use worlds::{Drawn, SPLITS, Split, draw};
