//! Message from the world to the controller, once per control sample.

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

impl Sample {
    /// The sample before the first, of so many joints.
    pub fn of(joints: usize) -> Self {
        let zero = vec![0.0; joints];
        Self { joints: vec![Measurement::default(); joints], accepted: zero, ..Self::default() }
    }

    /// Takes over another sample of as many joints, in the room that there is.
    pub fn take(&mut self, other: &Self) {
        (self.sequence, self.t_ns) = (other.sequence, other.t_ns);
        self.joints.clone_from(&other.joints);
        self.accepted.clone_from(&other.accepted);
    }
}
