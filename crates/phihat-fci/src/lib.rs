#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! The Franka Control Interface, for torque control: both sides of the wire.
//!
//! [`Client`] talks to a robot. [`RobotSide`] is the robot's side as a state machine, bytes in and bytes out;
//! [`Host`] puts sockets around it and a [`World`] behind it, so that any program made for a Franka can be
//! tested without one. Protocols 5 and 10, see [`Protocol`].
//!
//! # Sequence
//!
//! TCP: Connect; one state comes by UDP; Move, answered by status 1; states show that the motion runs, and
//! each is answered by UDP with its number and torques; a finish flag ends the motion, and the request gets
//! its second answer, status 0. A robot that stops shows the reason in a state and in that answer (status 6
//! in version 5, 8 in version 10), and takes no motion until it has recovered.
//!
//! # Guarantee
//!
//! Whatever bytes come, nothing panics, and nothing is allocated by what they claim. A cycle does not allocate.
//!
//! # References
//!
//! libfranka and libfranka-common (Franka Robotics, Apache-2.0): `network.h`, `robot_impl.cpp`,
//! `rbk_types.h`, `service_types.h`, `error.h`. Facts are taken from there, no code.
#![forbid(unsafe_code)]

mod client;
mod command;
mod error;
mod fault;
mod host;
mod numbers;
mod protocol;
mod request;
mod robot_side;
mod state;

pub use client::{Client, STATE_WAIT};
pub use command::RobotCommand;
pub use error::FciError;
pub use fault::{Faults, Reflex};
pub use host::{Event, Host, Pace, World};
pub use protocol::{JOINTS, PORT, Protocol};
pub use robot_side::{
    Ending, HangUp, Heard, InterfaceMode, Packets, RobotCycle, RobotRules, RobotSide,
};
pub use state::{NO_POSE, RobotMode, RobotState, StateSensed};
