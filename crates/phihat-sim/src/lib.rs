//! The only closed loop of the project: sense → control → limit → drive → integrate.
//!
//! [`Simulation`] takes a study and gains, and returns a [`Trace`] and [`Metrics`]. It depends neither on the
//! design nor on the rivals: whoever judges did not tune. An external controller comes in as a [`Driver`], or
//! takes the loop sample by sample as [`Stepped`], many of them in lockstep by [`Abreast`];
//! [`Simulation::apart`] returns both sides of the loop separately.
//!
//! # Example
//!
//! ```
//! use phihat::{Form, JointDesign, JointGains};
//! use phihat_sim::{Metrics, Simulation};
//! use phihat_study::Study;
//!
//! let text = r#"
//!     duration_s = 2.0
//!     [robot]
//!     name = "planar3r"
//!     [spec]
//!     settle_s = 1.0
//!     error_max_rad = 2e-3
//!     [gains]
//!     order = 1
//!     bandwidth_rad_s = 20.0
//!     estimator_bandwidth_rad_s = 70.0
//!     inertia_kg_m2 = [0.42, 0.18, 0.14]
//!     [reference]
//!     kind = "sines"
//!     center = "ready"
//!     fade_in_s = 1.0
//!     [[reference.sine]]
//!     amplitude_rad = 0.2
//!     frequency_hz = 0.3
//! "#;
//! let study = Study::from_text(text, "demo.toml", "".as_ref())?;
//! let joint = |inertia: f64| {
//!     let (kp, kd, period, form) = (400.0, 40.0, 1e-3, Form::Observer);
//!     JointGains::new(&JointDesign { inertia, kp, kd, a: &[70.0], period, form })
//! };
//! let law = [joint(0.42)?, joint(0.18)?, joint(0.14)?];
//!
//! let run = Simulation::new(&study, &law)?.run(|_samples| ());
//! let metrics = Metrics::of(&run.trace, &study);
//! assert!(run.divergence.is_none() && metrics.within_spec);
//!
//! // The same study and gains: the same trace, bit for bit.
//! assert!(Simulation::new(&study, &law)?.run(|_| ()).trace == run.trace);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Not claimed
//!
//! The simulator is a model too. Dry friction is smooth below 1 mrad/s unless a study asks for stiction.
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
mod feedforward;
mod forecast;
mod in_force;
mod integrator;
mod metrics;
mod motion;
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
pub use columnar::{ChunkReader, Kind, ParquetError, ParquetTable, Texts, Values};
pub use control::ControlSide;
pub use demand::{Demand, PhiAlong};
pub use driver::{Driver, Moment};
pub use error::{OutOfReach, SimError};
pub use feedforward::{FeedForward, fed_along};
pub use forecast::forecast;
pub use integrator::{Acceleration, Rk4, integrate_adaptive};
pub use metrics::{JointMetrics, Measured, Metrics, Stopped};
pub use motion::Motion;
pub use observed::Observed;
pub use overload::{Lack, Overload, overload};
pub use recorder::{FIGURES_BLOCK, Recorder};
pub use rows::{Acted, Row, Rows};
pub use sample::Sample;
pub use simulation::{DIVERGED, Divergence, Ended, Outcome, Simulation, samples};
pub use stepped::Stepped;
pub use survival::{Survival, Surviving};
pub use tip::{TipMetrics, error_for_tip};
pub use trace::{JointTrace, Supervision, Trace};
pub use trace_csv::TraceWriter;
pub use trace_file::{BLOCK, Place, TraceError, is_parquet};
#[cfg(feature = "mcap")]
pub use trace_mcap::McapTrace;
pub use trace_parquet::ParquetTrace;
pub use world::{Abort, COULOMB_VELOCITY, Friction, StopReason, derive_substeps};
