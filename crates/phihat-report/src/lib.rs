#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! A run's record as one self-contained page and as static figures.
//!
//! A pure function of recorded data: nothing is run, read or written here, no clock is looked at,
//! and the same [`Record`] gives the same bytes.
//!
//! [`page`] answers, in this order: did it hold, by how much, what did every joint do, with which
//! gains, in which world, and how is it made again. It needs no network, prints on paper (static
//! figures stand in for the interactive plots) and fits a phone. [`figures`] gives the same
//! figures alone, as SVG. [`kit`] has figures as data and the one drawer of them, for any page.
#![forbid(unsafe_code)]

mod arm;
mod band;
mod bound_words;
mod budget;
mod bullet;
mod certificate;
mod chart;
mod claimed;
mod class;
mod class_section;
mod coarser;
mod coupled;
mod drawing;
mod figure;
mod kind;
pub mod kit;
mod limit;
mod limited;
mod page;
pub mod parts;
mod payload;
mod poles;
mod policy;
mod promise;
mod record;
mod scope;
mod sections;
mod signal;
mod stage;
mod standing;
mod stretches;
mod supervision;
mod table;
mod tube;
mod tube_section;
mod verdict;

pub use arm::{ArmLink, DrawnArm, DrawnLoad, JointTorque, Plane, PointForce, Surface};
pub use band::Envelope;
pub use bound_words::{scope_of_bound, stop_in_words};
pub use budget::budget_page;
pub use claimed::{ClaimedBound, claimed_bound};
pub use drawing::Drawing;
pub use figure::{FIGURES, figures, run_figures};
pub use kit::draw::Picture;
pub use limited::limits_acted;
pub use page::page;
pub use poles::section_poles;
pub use record::{Record, RecordedBound, RunInfo, RunMeasurements};
pub use table::{torque, tracking};
pub use tube::{TubeRun, TubeSeen};
