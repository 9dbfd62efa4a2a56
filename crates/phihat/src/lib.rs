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
//! - [`Controller`]: an array of joints for a robot; [`update_joints`] for a number known at run time.
//! - [`Limits`], [`Delay`]: torque and torque-rate limits that report what they did; transport delay.
//! - [`Supervisor`]: what a real arm needs around it: a guard for bad, late and lost samples, joint limits,
//!   modes with a latched safe stop, bumpless starts. [`supervise`] for a number of joints known at run time.
//! - At the boundary: [`JointMap`] binds joints by name, [`Unwrap`] undoes the wrap of continuous joints,
//!   [`VelocityFilter`] differences positions, [`Shaper`] limits references, [`Log`] never blocks.
//!
//! # Example
//!
//! ```
//! use phihat::{
//!     Controller, Form, JointDesign, JointGains, JointState, Limits, Measurement, Reference,
//! };
//!
//! // A nominal inertia, an outer loop of 20 rad/s, an estimator with both poles at 70 rad/s, 1 kHz.
//! let design = JointDesign {
//!     inertia: 0.25, kp: 400.0, kd: 40.0, a: &[4900.0, 140.0], period: 1e-3, form: Form::Observer,
//! };
//! let limits = Limits::new(Some(40.0), None, 1e-3)?; // N·m
//! let controller = Controller::<f64, 1>::new([JointGains::new(&design)?.with_limits(limits)]);
//! let mut state = [JointState::new()];
//!
//! // A pendulum of 2 kg on 0.4 m (0.32 kg·m²), of which the controller is told nothing, to be held at 0.5 rad.
//! let reference = [Reference { q: 0.5, dq: 0.0, ddq: 0.0 }];
//! let (mut q, mut dq, mut tau) = (0.0_f64, 0.0, 0.0);
//! for _ in 0..2000 {
//!     let measurement = [Measurement { q, dq, tau_applied: tau }];
//!     let [command] = controller.update(&mut state, &measurement, &reference);
//!     tau = command.tau;
//!     dq += 1e-3 * (tau - 2.0 * 9.81 * 0.4 * q.sin()) / 0.32;
//!     q += 1e-3 * dq;
//! }
//! assert!((q - 0.5).abs() < 1e-6); // there, with gravity found
//! # Ok::<(), phihat::GainError>(())
//! ```
//!
//! # Real time
//!
//! `no_std`, no dependency, no heap, no panic, no clock, no `unsafe`; `f32` or `f64`. This crate cannot
//! see a robot model: "model-free" is a fact of the dependency graph.
//!
//! # Not claimed
//!
//! This is research software, not a safety function. It does not replace an emergency stop, and valid
//! gains are not yet stable gains on a given arm.
//!
//! # Where next
//!
//! [`Supervisor`] for a real arm; the crate `phihat-design` for gains from an error bound; `examples/rust` of the
//! repository for whole programs.
#![no_std]
#![forbid(unsafe_code)]

mod controller;
mod delay;
mod estimate;
mod filtered_gains;
mod gain_error;
mod gains;
mod gate;
mod innovation;
mod joint;
mod joint_map;
mod law;
mod limits;
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
mod unwrap;
mod velocity;

pub use controller::{Controller, update_joints};
pub use delay::{DELAY_MAX, Delay, DelayTooLong};
pub use gain_error::{Gain, GainError};
pub use gains::{Form, JointDesign, JointGains, ObserverNumbers};
pub use gate::{Gate, Outlet, Released, Tank};
pub use innovation::{InnovationSection, SECTIONS_MAX};
pub use joint::{Command, JointState, Measurement, Reference, Status};
pub use joint_map::{JointMap, JointMapError, order_hash};
pub use limits::Limits;
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
