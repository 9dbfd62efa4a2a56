//! Fronts of error against torque noise: `phihat fronts`.
//!
//! Every law is tuned under several caps on its torque noise, from several random starts, in drawn worlds;
//! one of its tunings is chosen in other worlds, and measured in worlds that were not used before. Laws are
//! compared with laws of equal knowledge, of the arm and of the loop's time, at equal noise, and one law under two
//! names shows how far apart chance puts a law from itself.
//!
//! # Not claimed
//!
//! That a law can do no better: its errors are those of the tunings that were found. Worlds are those that
//! [`draw`](crate::protocol::draw) draws; another arm, or a real robot, is not covered. The filter of the
//! velocity, the size of the nominal inertia and the torque that a law gets are free for every law that uses
//! them, and tuned with its own scalars; a law from positions alone may filter the positions.

mod begin;
mod extent;
mod gather;
mod hand_on;
mod job;
mod options;
mod page;
mod picture;
mod plan;
mod record;
mod tier;
mod verdict;
mod versus;

pub use extent::FrontsExtent;
pub use options::{FrontsAnswer, FrontsOptions};
pub use page::fronts_page;
pub use plan::FrontsPlan;
pub use record::{
    AtCap, ChosenGains, FRONTS_FORMAT, Fronts, HeldOut, LawRecord, Ordered, Restart, Versus, Volume,
};
pub use tier::{LoopKnowledge, Tier};
