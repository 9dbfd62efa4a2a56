//! Gains have to bear more than the worlds that they are tuned in.

use phihat_session::set;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

/// Gain of every drive in the raised-gain trial of a margin.
pub const LOUDER: f64 = 1.3;

/// Perturbation of a world's loop in the trial of a margin; the law is not changed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Harder {
    /// Torque that acts per commanded torque, the same for every drive.
    pub gain: f64,
    /// Additional samples of delay.
    pub delay: u32,
}

impl Harder {
    /// The world as it is.
    pub const NOT: Self = Self { gain: 1.0, delay: 0 };
    /// The two trials of a margin: drives with a gain of 1.3, and a torque that acts one sample later. Gains
    /// pass a trial where the arm still follows.
    pub const TRIALS: [Self; 2] = [Self { gain: LOUDER, delay: 0 }, Self { gain: 1.0, delay: 1 }];

    /// Puts it into a study's table, on top of a world whose torques act `delay` samples late.
    pub(crate) fn change(self, table: &mut Table, delay: u32, joints: usize) {
        set(table, &["loop", "delay_samples"], i64::from(delay + self.delay).into());
        // A drive of gain 1 would be none, and keep the run out of lanes.
        if self.gain > 0.0 && (self.gain - 1.0).abs() > 0.0 {
            let gains = vec![Value::from(self.gain); joints];
            set(table, &["world", "drive", "gain"], Value::Array(gains));
        }
    }
}
