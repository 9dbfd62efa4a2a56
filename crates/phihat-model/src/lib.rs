//! Robot description and rigid-body dynamics.
#![forbid(unsafe_code)]

mod body;
mod columns;
mod compile;
mod description;
mod energy;
mod error;
mod extras;
mod forward_dynamics;
mod four;
mod inertia;
mod inertia_range;
mod inverse_dynamics;
mod inverse_kinematics;
mod kinematics;
mod mass_matrix;
mod model;
mod placement;
mod regressor;
mod robot;
mod scalar;
mod trig;
mod urdf;
mod vector;
mod workspace;

pub use body::Body;
pub use error::{ModelError, RobotError};
pub use four::{Four, Quad};
pub use inertia_range::InertiaRange;
pub use inverse_kinematics::{IkError, IkOptions, Target};
pub use kinematics::Pose;
pub use model::{FrameId, GRAVITY, Model};
pub use robot::{Friction, Joint, JointKind, Robot, Sigmoid};
pub use scalar::Scalar;
pub use workspace::Workspace;
