//! Many runs with one answer.
//!
//! A campaign is a list of runs, each with an id that stands for everything that decides its outcome, and a
//! [`Journal`] of what is done. [`run_all`] does the rest on several threads; interrupt it at any instant and
//! start it again, and the answer is the same, byte for byte.
//!
//! [`faults`] is the campaign that breaks everything an arm, its sensors, its drives and its network can
//! break, and says what became of it.
//!
//! [`compare`] measures the rivals of the paper on the same arms. [`reproduce`] computes the paper again, statement by statement.
//!
//! [`disk`] is how results are written: whole or not at all, by one process at a time in a folder.
//!
//! # Not claimed
//!
//! Runs are simulated. What no fault of the table does to the arm is not in the answer.
#![forbid(unsafe_code)]

mod along;
pub mod compare;
mod dice;
pub mod disk;
pub mod faults;
mod hash;
mod journal;
pub mod reproduce;
mod runner;
mod typed_phi;

pub use along::{arm_along, coupled_along, motion_along, phi_along};
pub use dice::Dice;
pub use hash::sha256;
pub use journal::{Journal, JournalError};
pub use runner::{Ended, Progress, run_all};
pub use typed_phi::typed_phi_holds;
