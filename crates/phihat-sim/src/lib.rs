//! The only closed loop of the project: sense → control → limit → drive → integrate.
//!
//! [`Simulation`] takes a study and gains, and leaves a [`Trace`] and [`Metrics`]. It sees neither the
//! design nor the rivals: whoever judges did not tune. A controller from elsewhere comes in as a [`Driver`].
#![forbid(unsafe_code)]

mod control;
mod curve;
mod demand;
mod driver;
mod echo;
mod error;
mod forecast;
mod integrator;
mod metrics;
mod motion;
mod observed;
mod sample;
mod simulation;
mod spline;
mod supervision;
mod survival;
mod trace;
mod trace_csv;
#[cfg(feature = "parquet")]
mod trace_parquet;
mod world;

pub use demand::{Demand, PhiAlong};
pub use driver::{Driver, Moment};
pub use error::SimError;
pub use forecast::forecast;
pub use integrator::{Acceleration, Rk4, integrate_adaptive};
pub use metrics::{JointMetrics, Measured, Metrics};
pub use motion::Motion;
pub use observed::Observed;
pub use sample::Sample;
pub use simulation::{DIVERGED, Divergence, Ended, Outcome, Simulation, samples};
pub use survival::Survival;
pub use trace::{JointTrace, Supervision, Trace};
pub use trace_csv::{BLOCK, TraceError, TraceWriter};
#[cfg(feature = "parquet")]
pub use trace_parquet::ParquetTrace;
pub use world::{Abort, COULOMB_VELOCITY, Friction};
