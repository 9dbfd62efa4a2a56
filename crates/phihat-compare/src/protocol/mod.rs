//! Parts of a comparison of laws at equal noise: the noise figure, the order of candidates under constraints,
//! and the worlds that are drawn.
//!
//! Computations over all laws, caps and restarts are in [`fronts`](crate::fronts).

mod assess;
mod feasible;
mod margin;
mod noise;
mod worlds;

pub use assess::{Assayed, AssessedRun, Assessor, BestOfCap, FOLLOWING, PER_SCALAR, random_start};
pub use feasible::{Assessed, CAPS, better};
pub use margin::{Harder, LOUDER};
pub use noise::{NOISE_FROM_HZ, noise_above};
pub(crate) use worlds::hardest;
pub use worlds::{Drawn, SPLITS, Split, draw};
