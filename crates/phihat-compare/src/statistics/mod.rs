//! Statistics of a comparison: how much better one law is than another, and whether that is more than chance.
//!
//! Everything here is a pure function of figures, and knows no law, arm or world.

mod front;
mod holm;
mod paired;
mod ranks;
mod verdict;

pub use front::{Point, Spread, front, hypervolume, quantile};
pub use holm::holm;
pub use paired::{Bootstrap, Figures as ErrorTable, PairError, Ratio, ratio};
pub use ranks::{Ranks, critical_difference, ranks, studentized_range};
pub use verdict::{NOTICEABLE, Placebo, Standing, placebo, standing};
