#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! The only closed loop of the project: sense → control → limit → drive → integrate.
//!
//! [`Simulation`] takes a study and gains, and returns a [`Trace`] and [`Metrics`]. It depends neither on the
//! design nor on the rivals: whoever judges did not tune. An external controller comes in as a [`Driver`], or
//! takes the loop sample by sample as [`Stepped`], many of them in lockstep by [`Abreast`];
//! [`Simulation::apart`] returns both sides of the loop separately.
//!
//! # Where next
//!
//! [`Trace`] for the record, [`Metrics`] for the figures, [`Demand`] and [`Observed`] for what a design may know of φ.
#![forbid(unsafe_code)]

mod abreast;
mod apart;
mod batch;
mod columnar;
mod control;
mod curve;
mod demand;
mod driver;
mod echo;
mod error;
mod error_share;
mod external;
mod feedforward;
mod forecast;
mod in_force;
mod integrator;
mod jerk_limited;
mod metrics;
mod motion;
mod motion_extent;
mod observed;
mod overload;
mod recorder;
mod rows;
mod sample;
mod simulation;
mod spline;
mod stepped;
mod supervision;
mod survival;
mod tip;
mod trace;
mod trace_csv;
mod trace_file;
#[cfg(feature = "mcap")]
mod trace_mcap;
mod trace_parquet;
mod world;

pub use abreast::Abreast;
pub use apart::{Sensed, WorldSide};
pub use batch::Batch;
pub use columnar::{ChunkReader, ParquetError, ParquetTable, Texts, ValueKind, Values};
pub use control::ControlSide;
pub use demand::{Demand, PhiAlong};
pub use driver::{Driver, Moment};
pub use error::{OutOfReach, SimError};
pub use error_share::{ErrorShares, LargestShare};
pub use external::{
    ContactEvent, ContactReach, ContactRecord, ContactRefusal, ContactWatch, PayloadEstimate,
    VelocityErrorBounds,
};
pub use feedforward::{FeedForwardTorque, fed_along};
pub use forecast::forecast;
pub use integrator::{AccelerationOf, Rk4, integrate_adaptive};
pub use metrics::{JointMetrics, Measured, Metrics, Stopped};
pub use motion::Motion;
pub use motion_extent::{Extreme, JointExtent, SampledMotion};
pub use observed::Observed;
pub use overload::{Lack, Overload, overload};
pub use recorder::{FIGURES_BLOCK, Recorder};
pub use rows::{Acted, Row, Rows};
pub use sample::Sample;
pub use simulation::{DIVERGED, Divergence, Ended, Simulation, SimulationOutcome, samples};
pub use stepped::Stepped;
pub use survival::{Survival, Surviving};
pub use tip::{TipMetrics, error_for_tip};
pub use trace::{JointTrace, Supervision, Trace};
pub use trace_csv::TraceWriter;
pub use trace_file::{BLOCK, Place, TraceError, is_parquet};
#[cfg(feature = "mcap")]
pub use trace_mcap::McapTrace;
pub use trace_parquet::ParquetTrace;
pub use world::{Abort, COULOMB_VELOCITY, SimulatedFriction, StopReason, derive_substeps};
