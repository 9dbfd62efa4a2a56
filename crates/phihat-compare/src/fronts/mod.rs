//! Fronts of error against torque noise: `phihat fronts`.
//!
//! Every law is tuned under several caps on its torque noise, from several random starts, in drawn worlds; among its tunings one is
//! chosen in other worlds, and measured in worlds that nobody has seen before. Laws are held against laws of equal knowledge, at equal
//! noise, and one law under two names says how far apart chance puts one law from itself.
//!
//! # Not claimed
//!
//! That a law can do no better: its errors are those of the tunings that were found. What is drawn is what [`draw`](crate::protocol::draw)
//! draws; another arm, or a robot, is another question. How the velocity is filtered, how large the nominal
//! inertia in a law is, and which torque it is fed with is free for every law that uses it, and tuned with its own scalars; a law from
//! positions alone may filter these.

mod begin;
mod extent;
mod gather;
mod job;
mod options;
mod page;
mod plan;
mod plot;
mod record;
mod tier;

pub use extent::FrontsExtent;
pub use options::{FrontsAnswer, FrontsOptions};
pub use page::fronts_page;
pub use plan::FrontsPlan;
pub use record::{
    AtCap, Chosen, FRONTS_FORMAT, Fronts, HeldOut, LawRecord, Ordered, Restart, Versus, Volume,
};
pub use tier::Tier;
