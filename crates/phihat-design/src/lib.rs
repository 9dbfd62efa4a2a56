//! From a study's specification to gains that are proved, or a "no" with its reason.
//!
//! [`design()`] searches; [`Certificate`] holds what is claimed, as data; [`Certificate::verify`] checks it again
//! from the gains alone. [`claims`] are about the continuous law, [`sampled`] about the loop as it runs.
//!
//! # Not claimed
//!
//! Limits in action, contacts, and postures that were not sampled are outside of every claim.
#![forbid(unsafe_code)]

mod arm;
mod certificate;
pub mod claims;
mod contradiction;
pub mod coupled;
mod designer;
pub mod export;
pub mod prelude;
mod quick;
mod request;
pub mod sampled;
mod trace;
mod trade_off;
pub mod tube;

pub use arm::{Arm, ArmError, InertiaRates, ProofProgress, Unproved};
pub use certificate::{arm_inside_window, find_moving};
pub use contradiction::{Contradiction, ContradictionError, typed_inertia_holds};
pub use designer::{
    Alternative, Clause, DesignError, Infeasible, Outcome, PhiOf, alternatives, design, search,
};
pub use phihat_certificate::{
    ArmBasis, ArmInertia, Bounds, Certificate, CoupledGains, ErrorBound, FORMAT, FrozenPayload,
    FrozenPosture, Gains, GainsError, JointCertificate, JointKept, JointRecord, JointRun, Left,
    LeftOut, Motion, NotCounted, PayloadSet, Phi, PhiBasis, Proved, Quantity, Searched, Settle,
    SettleFrom, Statement, TradeOff, Tube, TubeJoint, TubeKept, TubeWatch, VERSION, Verified,
    Witness,
};
pub use request::requested_gains;
pub use trace::{EstimateError, InertiaEstimate, JointSignals, estimate_inertia};
