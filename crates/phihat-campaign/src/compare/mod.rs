//! The rivals of the paper's Table 1, measured on the same arms.

mod adapter;

pub use adapter::{Adapter, supply};
