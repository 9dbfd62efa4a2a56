#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! From a study's specification to gains that are proved, or a "no" with its reason.
//!
//! [`design()`] searches; [`Certificate`] holds what is claimed, as data; [`Certificate::verify`] checks it again
//! from the gains alone. [`claims`] are about the continuous law, [`sampled`] about the loop as it runs.
//!
//! # Example
//!
//! ```
//! use phihat_design::{Arm, Outcome, Phi, PhiBasis, arm_inside_window, design};
//!
//! # let text = r#"
//! #     duration_s = 2.0
//! #     [robot]
//! #     name = "planar3r"
//! #     [spec]
//! #     settle_s = 1.0
//! #     error_max_rad = 0.02
//! #     [design]
//! #     orders = [1]
//! #     payload_max_kg = 0.2
//! #     [reference]
//! #     kind = "sines"
//! #     center = "ready"
//! #     fade_in_s = 1.0
//! #     [[reference.sine]]
//! #     amplitude_rad = 0.2
//! #     frequency_hz = 0.3
//! # "#;
//! # let study = phihat_study::Study::from_text(text, "demo.toml", "".as_ref())?;
//! // `study` states the largest error and the largest payload, and no gains.
//! let arm = Arm::of(&study)?;
//!
//! // Bounds on φ per joint, the torque that the controller does not know: its rate and its jumps. From a simulator,
//! // from a recorded trace, or typed as here.
//! let phi = |_joint: usize, _inertia: f64| Phi {
//!     basis: PhiBasis::Typed,
//!     source: "an estimate by hand".to_owned(),
//!     size_nm: Some(15.0),
//!     rate_nm_s: 30.0,
//!     jump_nm: 0.5,
//!     motion: None,
//! };
//! let Outcome::Designed(gains) = design(&study, &arm, &phi)? else { return Ok(()) };
//! let certificate = gains.certificate.as_ref().ok_or("no certificate")?;
//! certificate.verify(&gains)?; // by methods that the search does not know
//! arm_inside_window(&study, &arm, &gains)?; // only then may they run
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Joints push each other, which bounds that go joint by joint do not count: [`tube::tube`] finds an envelope
//! of the error of a whole run, as the command `phihat design` does.
//!
//! # Where next
//!
//! [`sampled::FindWindow`] for the inertia window alone, [`requested_gains`] for gains that a study states,
//! [`export::export`] for ROS 2, C and tables, `examples/rust/04_design.rs` of the repository for a design
//! with its tube.
#![forbid(unsafe_code)]

mod arm;
pub mod budget;
mod certificate;
pub mod claims;
mod contradiction;
pub mod coupled;
mod designer;
pub mod export;
mod lanes;
mod limit;
mod parallel;
mod positions;
pub mod prelude;
mod quick;
mod request;
mod reversals;
pub mod sampled;
mod smoothed;
mod trace;
mod trade_off;
pub mod tube;

pub use arm::{Arm, ArmError, InertiaRates, ProofProgress, Unproved};
pub use certificate::{arm_inside_window, find_moving};
pub use contradiction::{Contradiction, ContradictionError, typed_inertia_holds};
pub use designer::{
    Alternative, Clause, DesignError, Infeasible, Outcome, PhiOf, alternatives, design, has_law,
    search,
};
pub use limit::{Limit, LimitError, LimitRequest, beside_limit, limit};
pub use phihat_certificate::{
    ArmBasis, ArmInertia, Bounds, Certificate, CoarserEncoder, CoupledGains, ErrorBound, FORMAT,
    FilterSection, FrozenPayload, FrozenPosture, Gains, GainsError, JointCertificate, JointKept,
    JointLimit, JointRecord, JointRun, Left, LeftOut, Motion, NotCounted, PayloadSet, Phi,
    PhiBasis, PositionObserver, Proved, Quantity, Searched, Settle, SettleFrom, Statement,
    TradeOff, Tube, TubeJoint, TubeKept, TubeWatch, VERSION, Verified, Witness,
};
pub use positions::{PositionEstimate, PositionSearch, TubeParts};
pub use request::requested_gains;
pub use reversals::DryFriction;
pub use smoothed::{RecordedJoint, Smoothed};
pub use trace::{
    EstimateError, InertiaEstimate, JointSignals, estimate_inertia, estimate_inertia_of,
};
