//! Claims about the loop as it is sampled: inertia window, margins, torque noise.
//!
//! One joint against the scalar plant `M q̈ = τ − φ`, in units of its nominal inertia `M̄`: `μ = M/M̄`. The
//! model of the loop, [`LoopModel`], is that of the simulator and of the core, sample by sample.
//!
//! # Method
//!
//! With `λ = 1/μ` the characteristic polynomial is `Δ(z) + λ N(z)`, and `N`, `Δ` do not depend on the
//! inertia ([`OpenLoop`]). A root can cross the unit circle only where this vanishes on it: the inertia
//! window, its margins and their proofs ([`InertiaWindow`], [`ModulusMargin`]) all come from one
//! frequency response. The state matrix ([`StateMatrix`]) gives what needs time: noise, steps, peaks.
//!
//! # Not claimed
//!
//! Coupling between joints with different gains, torque and rate limits in action, and friction are
//! outside of this linear loop.

mod bode;
mod common_form;
pub(crate) mod control_side;
pub(crate) mod eigenvalues;
mod estimator;
mod exclusion;
mod held;
mod law;
mod margins;
mod model;
mod moving;
mod noise;
mod open_loop;
mod peak;
pub(crate) mod placed;
mod polynomial;
mod reading;
mod reference;
mod refutation;
mod response;
mod riccati;
pub(crate) mod sample;
mod sampled_varying;
mod state_matrix;
mod step;
mod varying;
mod window;

pub(crate) use estimator::estimator_coefficients;

pub use bode::{Bode, bode};
pub(crate) use exclusion::{from_segment, stable_at_gain};
pub(crate) use held::SampledGains;
pub(crate) use law::Law;
pub(crate) use margins::least_modulus;
pub use margins::{FindMargins, Margins, ModulusMargin};
pub use model::LoopModel;
pub(crate) use model::{LoopParts, SampledDrive};
pub use moving::{FindMoving, Moving};
pub use noise::{FindNoise, TorqueNoise};
pub use open_loop::OpenLoop;
pub(crate) use peak::mean_of_line;
pub use peak::{FindSampledPeaks, SampledPeaks};
pub use reading::{FindReadingError, ReadingError};
pub(crate) use reference::left_by_acceleration;
pub use reference::{FindReferenceError, ReferenceError};
pub(crate) use response::ratios;
pub use sampled_varying::{FindSampledVarying, SampledVarying};
pub use state_matrix::{Reaction, StateMatrix};
pub use step::{FindStep, LargestStep};
pub use varying::{FindVarying, VaryingWindow};
pub use window::{FindWindow, InertiaWindow};
