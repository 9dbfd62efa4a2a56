//! Checking a whole certificate against the gains that carry it.
//!
//! Every claim's own file checks that claim; here it is asked whether the claims fit together, and each is put to its check.

mod arm;
mod bounds;
mod document;
mod joint;
mod tip;
mod tube;

pub use joint::RATIOS;
