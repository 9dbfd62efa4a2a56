//! Statistics of many runs: means, quantiles, intervals, and how much better one law is than another.
//!
//! The one place for them. Everything here is a pure function of numbers and knows no law, arm or world.

mod front;
mod holm;
mod intervals;
mod means;
mod paired;
mod quantile;
mod ranks;
mod verdict;

pub use front::{FrontPoint, front, hypervolume};
pub use holm::holm;
pub use intervals::{CONFIDENCE, Places, quantile_places, share_interval};
pub use means::{geometric_mean, mean, rms};
pub use paired::{Bootstrap, ErrorTable, PairError, Ratio, ratio};
pub use quantile::{Spread, quantile};
pub use ranks::{Ranks, critical_difference, ranks, studentized_range};
pub use verdict::{NOTICEABLE, Placebo, Standing, placebo, standing};
