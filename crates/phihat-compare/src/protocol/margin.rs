//! Gains have to bear more than the worlds that they are tuned in.

use phihat_session::set;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

/// By how much louder every drive is in the trial of a margin.
pub const LOUDER: f64 = 1.3;

/// What is made harder than a world for the margin's sake: the loop, not the law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Harder {
    /// Torque that acts per torque told, the same for every drive.
    pub gain: f64,
    /// Samples of delay more.
    pub delay: u32,
}

impl Harder {
    /// The world as it is.
    pub const NOT: Self = Self { gain: 1.0, delay: 0 };
    /// The two trials of a margin: drives that are 1.3 times as loud, and a torque that is one sample later. Gains survive them where
    /// the arm still follows.
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
