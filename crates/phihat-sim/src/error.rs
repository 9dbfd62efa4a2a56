//! Why a study cannot be run.

use phihat_model::IkError;
use thiserror::Error;

/// Why an arm cannot be brought to a point of its reference.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OutOfReach {
    /// The frame that should follow is not there.
    #[error("the robot has no frame {0}")]
    NoFrame(String),
    /// Inverse kinematics found no posture.
    #[error(transparent)]
    NoPosture(#[from] IkError),
    /// The next posture is on another branch \[rad\].
    #[error("a joint would jump by {0:.3} rad")]
    Jump(f64),
}

/// A study that reads well, yet cannot be simulated.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SimError {
    /// The description that is fed forward.
    #[error("feedforward.mass_scale: {0}")]
    FeedForward(phihat_model::ModelError),
    /// Gains and robot disagree.
    #[error("the gains are for {gains} joints, the robot has {robot}")]
    JointCount {
        /// Joints the gains speak of.
        gains: usize,
        /// Joints of the robot.
        robot: usize,
    },
    /// The Cartesian reference leaves the arm's reach.
    #[error(
        "reference: at t = {t:.3} s the point ({:.4}, {:.4}, {:.4}) m cannot be reached: {reason}",
        point[0], point[1], point[2]
    )]
    Unreachable {
        /// When \[s\].
        t: f64,
        /// Position of the target \[m\].
        point: [f64; 3],
        /// Reason why it cannot be reached.
        reason: OutOfReach,
    },
    /// No motion to the setpoints is within their limits.
    #[error("reference: joint {joint}: {why}")]
    Setpoints {
        /// The joint.
        joint: String,
        /// Limit or travel that is wrong.
        why: phihat::GainError,
    },
    /// Friction, a spring or a wall is too stiff for the integration step.
    #[error(
        "world.substeps = {substeps} is too coarse for what is stiff on {joint}; {needed} or more are needed"
    )]
    TooStiff {
        /// The joint that it is on.
        joint: String,
        /// Integration steps that the study states.
        substeps: u32,
        /// Integration steps that are needed.
        needed: u32,
    },
    /// A limit or the delay is out of range.
    #[error("{0}")]
    Limit(String),
    /// The payload cannot be attached.
    #[error("world.payload: {0}")]
    Payload(String),
    /// A kind of reference that this version does not know.
    #[error("this kind of reference is not known to the simulator")]
    UnknownReference,
    /// The options of the supervisor do not fit the gains.
    #[error("supervisor: {0}")]
    Supervisor(String),
}
