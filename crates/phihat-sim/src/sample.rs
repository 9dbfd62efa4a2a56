//! What passes from the world to the controller, once per control sample.

use phihat::Measurement;

/// One message of measurements.
///
/// A message that did not arrive shows as the one before: same sequence number, same time stamp.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sample {
    /// Number of the message, one more than the one sent before it.
    pub sequence: u64,
    /// When it was measured \[ns\] since the start of the run.
    pub t_ns: u64,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<Measurement<f64>>,
    /// The command that the robot accepted last, one entry per joint \[N·m\]: its echo, before any delay.
    pub accepted: Vec<f64>,
}
