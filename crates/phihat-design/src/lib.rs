#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! Finders: laws for a specification, and the claims about them.
//!
//! [`design()`] searches for a candidate, joint by joint; [`tube::tube`] finds the envelope of the error of a whole
//! run; [`Certificate`] holds the claims, as data; [`Certificate::verify`] checks them again from the gains alone.
//! [`claims`] are about the continuous law, [`sampled`] about the loop as it runs. The way from a study to gains is
//! `phihat-synthesis`, which is made of these finders.
//!
//! # Example
//!
//! ```
//! use phihat_design::tube::{Desired, tube};
//! use phihat_design::{Arm, Outcome, Phi, PhiBasis, Settle, arm_inside_window, design};
//!
//! # let text = r#"
//! #     duration_s = 2.0
//! #     [robot]
//! #     name = "planar3r"
//! #     [spec]
//! #     settle_s = 1.0
//! #     error_bound_rad = 0.02
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
//! let Outcome::Designed(mut gains) = design(&study, &arm, &phi)? else { return Ok(()) };
//!
//! // A candidate: stable, and without a bound on its error, for joints push each other.
//! let mut certificate = gains.certificate.take().ok_or("no certificate")?;
//! assert!(certificate.error_bound(0).is_none());
//!
//! // The bound is that of the tube along the motion of the study.
//! let motion = phihat_sim::Motion::of(&study)?;
//! let desired = Desired::of(&study, |joint, t| motion.told(joint, t));
//! let tube = tube(&study, &gains, &desired)?;
//! let settle = Settle::of(&study, Some(&tube));
//! certificate.bound_by(tube.steady_from(settle.settle_s), settle, Vec::new());
//! assert!(certificate.error_bound(0).is_some_and(|bound| bound.error_bound_rad < 0.02));
//!
//! gains.certificate = Some(certificate);
//! let certificate = gains.certificate.as_ref().ok_or("no certificate")?;
//! certificate.verify(&gains)?; // by methods that the search does not use
//! arm_inside_window(&study, &arm, &gains)?; // only then may they run
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where next
//!
//! [`sampled::FindWindow`] for the inertia window alone, [`requested_gains`] for gains that a study states,
//! [`export::export`] for ROS 2, C and tables, `phihat_synthesis::synthesize` for gains whose tube keeps the
//! specification, `examples/rust/04_design.rs` of the repository for a program around it.
#![forbid(unsafe_code)]

mod arm;
mod bounded;
pub mod budget;
mod certificate;
pub mod claims;
mod class;
mod contradiction;
pub mod coupled;
mod designer;
pub mod elastic;
mod enclosed;
pub mod export;
mod lanes;
mod limit;
mod portable;
mod positions;
pub mod prelude;
mod quick;
mod request;
mod reversals;
pub mod sampled;
mod smoothed;
mod square;
mod trace;
mod trade_off;
pub mod tube;
mod undetermined;

pub use arm::{Arm, ArmError, InertiaRates};
pub use bounded::{BoundedCoefficient, bounded_coefficients};
pub use certificate::{arm_inside_window, find_moving};
pub use class::{
    ClassDemand, ClassRefusal, LeastError, class_bound, class_parts, quick_class_bound,
};
pub use contradiction::{Contradiction, ContradictionError, typed_inertia_holds};
pub use designer::{
    Alternative, Clause, DesignError, Infeasible, Outcome, PhiOf, alternatives, design, has_law,
    search,
};
pub use enclosed::{enclose_dry_friction, enclose_inertia, enclose_inertia_of};
pub use limit::{Limit, LimitError, LimitRequest, beside_limit, limit};
pub use phihat_certificate::{
    ArmBasis, ArmInertia, Bounds, Certificate, ClassBound, ClassPace, ClassPart, ClassSignals,
    ClassWitness, CoarserEncoder, CoupledGains, ElasticJoint, ElasticJoints, EncoderSide,
    ErrorBound, FORMAT, FilterSection, FrozenPayload, FrozenPosture, Gains, GainsError,
    JointCertificate, JointKept, JointLimit, JointRecord, JointRun, Left, LeftOut, NotCounted, Phi,
    PhiBasis, PositionObserver, Proved, Quantity, ReferenceBounds, Searched, Settle, SettleFrom,
    TradeOff, Tube, TubeJoint, TubeKept, TubePayloadSet, TubeWatch, VERSION, Verdict, Verified,
    VerifiedStatement, Witness,
};
pub use positions::{PositionEstimate, PositionSearch, TubeParts};
pub use request::requested_gains;
pub use reversals::DryFriction;
pub use smoothed::{FOURTH_VARIANCE, RecordedJoint, Smoothed, fourth_differences, near_turns};
pub use trace::{EstimateError, InertiaEstimate, JointSignals};
pub use undetermined::Undetermined;
