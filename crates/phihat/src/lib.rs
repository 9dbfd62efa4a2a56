#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! The real-time core of phihat: a robust-adaptive joint torque law that needs no model of the arm.
//!
//! Everything the law does not know (inertia, Coriolis and gravity torque, friction, payload) is one
//! signal per joint, `φ = τ_applied − M̄ q̈`. An order-m estimator finds it from the torque that acted and
//! the velocity that followed; a PD loop shapes the rest:
//!
//! ```text
//! τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂,      e = q − q_d
//! ```
//!
//! - [`JointGains`]: one joint's gains, checked once, immutable. [`JointState`]: what it remembers,
//!   owned by the caller. [`JointGains::update`]: the only verb of the hot path.
//! - [`JointGains::linear`]: the law between limits as one linear system, [`LinearLaw`], for whoever computes with it.
//! - [`Controller`]: an array of joints for a robot; [`update_joints`] for a number known at run time.
//! - [`Limits`], [`Delay`]: torque and torque-rate limits that report what they did; transport delay.
//! - [`Supervisor`]: what a real arm needs around it: a guard for bad, late and lost samples, joint limits,
//!   modes with a latched safe stop, bumpless starts. [`supervise`] for a number of joints known at run time.
//! - At the boundary: [`JointMap`] binds joints by name, [`Unwrap`] undoes the wrap of continuous joints,
//!   [`VelocityFilter`] differences positions, [`Shaper`] limits references, [`Log`] never blocks.
//!
//! # Real time
//!
//! `no_std`, no dependency, no heap, no panic, no clock, no `unsafe`; `f32` or `f64`. This crate cannot
//! see a robot model: "model-free" is a fact of the dependency graph.
//!
//! # Where next
//!
//! [`Supervisor`] for a real arm; the crate `phihat-design` for gains from an error bound; `examples/rust` of the
//! repository for whole programs.
//!
#![doc = include_str!("cookbook.md")]
#![no_std]
#![forbid(unsafe_code)]

mod boxed_shaper;
mod controller;
mod delay;
mod estimate;
mod filtered_gains;
mod form;
mod gain_error;
mod gains;
mod gate;
mod innovation;
mod joint;
mod joint_map;
mod law;
mod limits;
mod linear;
mod log;
mod position;
mod position_design;
mod position_gains;
mod real;
mod sampled;
mod shaper;
mod source;
mod square;
mod supervisor;
mod torque_filter;
mod unwrap;
mod velocity;

pub use boxed_shaper::{BoxedShaper, Braking};
pub use controller::{Controller, update_joints};
pub use delay::{DELAY_MAX, Delay, DelayTooLong};
pub use form::Form;
pub use gain_error::{Gain, GainError};
pub use gains::{JointDesign, JointGains, ObserverNumbers};
pub use gate::{Gate, Outlet, Released, Tank};
pub use innovation::{InnovationSection, SECTIONS_MAX};
pub use joint::{Command, JointState, Measurement, Reference, STATE_ENTRIES, StateEntry, Status};
pub use joint_map::{JointMap, JointMapError, order_hash};
pub use limits::Limits;
pub use linear::{LINEAR_INPUTS, LINEAR_SENT_MAX, LINEAR_STATES_MAX, LinearLaw};
pub use log::Log;
pub use position_design::PositionDesign;
pub use real::Real;
pub use shaper::{MotionLimits, Shaper};
pub use source::{TorqueSource, VelocitySource};
pub use supervisor::{
    Action, Answer, ArmRules, ArmState, Events, Fault, Funnel, JointMemory, JointOptions,
    JointRange, JointRules, Memories, Mode, ModeEvents, ModeRequest, OptionError, Options, Refusal,
    Report, Request, Rules, Sample, Schedule, Stamp, Supervisor, SupervisorState, Transition,
    next_mode, supervise,
};
pub use unwrap::Unwrap;
pub use velocity::{VelocityFilter, VelocityState};

/// Highest order of the estimator.
pub const ORDER_MAX: usize = 4;
