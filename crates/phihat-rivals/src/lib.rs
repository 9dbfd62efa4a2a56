#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! Rival controllers for robot arms, one file each, in one list: [`RIVALS`].
//!
//! A rival declares what it needs by type: the measurements it [`Sees`], the derivatives of the reference it
//! [`Wants`], what it [`Knows`] of the arm before it starts. It is handed that and nothing else, so that
//! "model-free" is a fact about a type: a law that knows [`Nothing`] has no way to a model.
//!
//! # To add one
//!
//! One file in `src/rivals/` that implements [`Rival`], and one line in `RIVALS`. Tests that every rival has to pass
//! find it there.
#![forbid(unsafe_code)]

mod adaptation;
mod basis;
mod card;
mod choice;
mod cited;
mod claim;
mod error;
mod facts;
mod filter;
mod friction;
mod handed;
mod lumped;
mod math;
mod measured;
mod needs;
mod nominal;
mod observer;
mod orbit;
mod planar;
mod regressor;
mod rival;
mod rivals;
mod running;
mod shared;
mod sliding;
mod supply;
mod tuning;

pub use card::{Card, Grade, Tick, Ticks};
pub use choice::{Chosen, SensedChoice};
pub use cited::{Cited, WITHOUT_ROW};
pub use claim::{Condition, DeclaredArm};
pub use error::RivalRefusal;
pub use facts::{
    Designed, DesignedFilters, DesignedPositions, Drives, Inertia, Nothing, Period, TorqueMax,
};
pub use friction::Dry;
pub use handed::{All, Knows, Sees, Wants};
pub use measured::{
    Acceleration, MeasuredMotion, MeasuredPositions, MotionAndCommand, MotionAndTorque,
    NoReference, PositionsAndTorque, Preview, Velocity,
};
pub use needs::Needs;
pub use nominal::{Gravity, Nominal, Viscous};
pub use orbit::Orbit;
pub use planar::{LINKS, Planar, Tip};
pub use regressor::{ParameterGroup, Regressor};
pub use rival::{Entry, Make, Rival};
pub use rivals::{INDUSTRIAL_PID, RIVALS, position_law, rival};
pub use running::Running;
pub use supply::{DesignedJoint, DesignedPosition, Supply, TaskCurve};
pub use tuning::{Scalar, Tuning};
