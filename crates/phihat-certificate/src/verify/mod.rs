//! Checking a whole certificate against the gains that carry it.
//!
//! Every claim's own file checks that claim; this module checks that the claims fit together, and calls each
//! check.

mod arm;
mod bounds;
mod document;
mod joint;
mod range;
mod tip;
mod tube;

pub use joint::RATIOS;
