//! The only closed loop of the project: sense → control → limit → drive → integrate.
#![forbid(unsafe_code)]

mod metrics;
mod trace;

pub use metrics::{JointMetrics, Metrics};
pub use trace::{JointTrace, Trace};
