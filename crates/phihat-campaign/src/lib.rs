#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! Many runs with one answer.
//!
//! A campaign is a list of runs, each with an id that stands for everything that decides its outcome, and a
//! [`Journal`] of what is done. [`run_all`] does the rest on several threads; interrupt it at any instant and
//! start it again, and the answer is the same, byte for byte.
//!
//! [`faults`] is the campaign that breaks everything an arm, its sensors, its drives and its network can
//! break, and says what became of it.
//!
//! [`sweep`] draws the numbers of a study anew in every run; [`rollouts`] gets them as arguments and returns
//! arrays. [`statistics`] is what is said of many of them.
#![forbid(unsafe_code)]

mod chunks;
pub mod faults;
mod folder;
mod journal;
mod page;
pub mod rollouts;
mod runner;
pub mod statistics;
pub mod sweep;

pub use chunks::{ChunkLayout, ChunksError, RowFile, Shard, run_chunks};
pub use folder::{JOURNAL, results_of};
pub use journal::{Journal, JournalError};
pub use page::faults_page;
pub use runner::{Progress, RunEnded, run_all};
