//! The first motion of an arm that nobody has gains for: a study made of another one, in which each joint moves a little while the others are
//! held, and what its record shows.
//!
//! # What keeps it safe
//!
//! Nothing is known but a guess of each joint's inertia. So the gains are the fastest of a short list whose window holds an arm that is
//! [`inertia_within`](FirstMotion::inertia_within) times lighter or heavier than the guess; a joint is told no torque beyond its cap; and the
//! supervisor stops the arm where a joint is further from its path than twice the amplitude.
//!
//! # Not claimed
//!
//! That it bears any drive: one that is wired the wrong way round is stopped by its error, after it moved that far. `φ` is that of one joint at
//! a time, near one posture: a faster motion of the whole arm has more.

mod measured;
mod plan;

pub use measured::{FIRST_WIDTH, FirstMeasured, MeasuredJoint, first_measured};
pub use plan::{FirstMotionError, FirstStudy, first_study};

/// What a first motion is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstMotion {
    /// How far each joint moves to either side \[rad, m\].
    pub amplitude: f64,
    /// Share of a joint's largest torque that it is told at most; what holds the described arm, where the robot does not add it, comes on top.
    pub torque_share: f64,
    /// By what factor the true inertia may be off from the guess, either way.
    pub inertia_within: f64,
}

impl Default for FirstMotion {
    fn default() -> Self {
        Self { amplitude: 0.05, torque_share: 0.3, inertia_within: 3.0 }
    }
}
