#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! One loop for every robot: wait for a sample, bind its joints, supervise, send, record.
//!
//! A [`Link`] connects the loop to a robot or to a simulation. Its [`Facts`] state who owns the clock, what
//! the robot adds to a torque and on what it stops; the study's `[profile]` is compared with them before
//! anything moves. [`SimLink`] is phihat's simulated arm, in lock-step or in real time; in lock-step a drive
//! writes the trace of `phihat run`, bit for bit.
//!
//! [`prepare`] checks study, gains, link and machine, and refuses by default; [`Prepared::drive`] runs the
//! loop on a thread of its own and writes trace, report and verdict as a simulation does, with the figures
//! that only a drive has: lost samples, timing, and the reason why it ended. [`Machine`] measures how late
//! this machine wakes a thread.
//!
//! # Real time
//!
//! The control thread does not allocate, lock, or make system calls except those of its link; the record
//! passes through a ring to the thread that writes it.
#![forbid(unsafe_code)]

mod bound;
mod cycles;
mod described;
mod error;
mod evidence;
mod facts;
mod finding;
mod franka;
mod hooks;
mod link;
mod machine;
mod on;
mod order;
mod other_end;
mod preflight;
mod prepared;
#[cfg(feature = "ros2")]
mod ros2;
mod sim;
mod tape;
mod timing;

#[cfg(not(target_os = "linux"))]
mod elsewhere;
#[cfg(target_os = "linux")]
mod linux;
#[cfg(not(target_os = "linux"))]
use elsewhere as system;
#[cfg(target_os = "linux")]
use linux as system;

pub use bound::DriveBound;
pub use cycles::{Desk, End, Park, Parked, Plan, Tally, cycles};
pub use error::DriveError;
pub use evidence::Evidence;
pub use facts::{Adds, Clock, Facts, Mismatch, Stops, Tells};
pub use finding::{Finding, SystemError, is_preempt_rt};
pub use franka::{FrankaAddress, FrankaLink};
pub use hooks::{Tap, Targets};
pub use link::{Link, LinkFault, Readiness, Standing, Unreadable, Wait};
pub use machine::{Machine, MachineOptions};
pub use on::{On, OnError};
pub use order::{Order, OrderError};
pub use preflight::{Check, CheckName, State};
pub use prepared::{DriveOptions, Driven, Prepared, prepare, prepare_on};
#[cfg(feature = "ros2")]
pub use ros2::{RosCounts, RosError, RosNode, RosOptions};
pub use sim::SimLink;
pub use tape::{Arrival, Cycle, Reader, Tape, ring};
pub use timing::{Percentiles, Timing};
