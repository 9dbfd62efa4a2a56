//! First motion of an arm without gains: a study derived from another one, in which each joint moves a little
//! while the others hold their position, and the measurements from its record.
//!
//! # What keeps it safe
//!
//! Nothing is known but a guess of each joint's inertia. So the gains are the fastest of a short list whose
//! window holds an arm that is [`inertia_within`](FirstMotion::inertia_within) times lighter or heavier than
//! the guess; a joint is commanded no torque beyond its cap; and the supervisor stops the arm where a joint
//! is further from its path than twice the amplitude.
//!
//! # Not claimed
//!
//! That it is safe with any drive: one that is wired the wrong way round is stopped by its error, after it
//! moved that far. `φ` is that of one joint at a time, near one posture: a faster motion of the whole arm has
//! more.

mod measured;
mod narrowed;
mod plan;

pub use measured::{FIRST_WIDTH, FirstMeasured, MeasuredJoint, first_measured};
pub use narrowed::{NarrowedArm, narrowed_arm};
pub use plan::{FirstMotionError, FirstStudy, first_study};

/// Parameters of a first motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstMotion {
    /// Amplitude of each joint to either side \[rad, m\].
    pub amplitude: f64,
    /// Share of a joint's largest torque that is commanded at most; the torque that holds the described arm,
    /// where the robot does not add it, comes on top.
    pub torque_share: f64,
    /// Factor by which the true inertia may differ from the guess, either way.
    pub inertia_within: f64,
}

impl Default for FirstMotion {
    fn default() -> Self {
        Self { amplitude: 0.05, torque_share: 0.3, inertia_within: 3.0 }
    }
}
