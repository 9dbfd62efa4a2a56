#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! Claims about gains, as data: the gains document and its certificate.
//!
//! This crate finds nothing: whoever checks a claim must not see how it was found. [`Gains`] is the document
//! `gains.json`; [`Certificate`] holds every claim about gains; [`Certificate::verify`] checks them by methods of its
//! own, from the file alone, and [`Certificate::verified`] says what was proved, what is taken on trust and what is not
//! counted. A claim that does not hold is a [`Refutation`]: the inequality that fails, with both its sides.
//!
//! # Where next
//!
//! `phihat-design` finds gains and claims; docs/theory of the repository has the theorems.
#![forbid(unsafe_code)]

mod arm;
mod assumptions;
mod attenuation;
mod bounds;
mod certificate;
mod check;
mod choices;
mod class;
mod clauses;
mod coarser;
mod continuous;
mod coupled;
mod derive;
#[cfg(test)]
mod dice;
mod elastic;
pub mod extremes;
mod frozen;
mod gains;
mod iss;
mod joint_limit;
mod law;
mod loaded;
mod margins;
mod model;
mod moving;
mod noise;
mod norm;
mod not_counted;
mod optimality;
mod outward;
mod paper;
pub mod parallel;
mod peak_gain;
mod peaks;
mod performance;
mod phi;
mod range;
mod reading;
mod record;
mod reference;
mod refutation;
mod replay;
mod settle;
mod step;
mod tip;
mod tip_again;
mod trade_off;
pub mod tube;
mod tube_again;
mod tube_document;
mod tube_kept;
mod varying;
mod verdict;
mod verified;
mod verified_range;
mod verify;
mod weights;
mod window;
mod witness;

pub use arm::{ArmBasis, ArmInertia};
pub use assumptions::Assumption;
pub use attenuation::{Attenuation, Interval};
pub use bounds::Bounds;
pub use certificate::{Certificate, ErrorBound, JointCertificate};
pub use class::{
    AlongBound, ClassAgain, ClassBound, ClassPace, ClassPair, ClassPart, ClassSignals,
    ClassWitness, JointOfClass, KnownMotion,
};
pub use coarser::CoarserEncoder;
pub use continuous::ContinuousLaw;
pub use coupled::{CoupledGains, FrozenPayload, FrozenPosture};
pub use elastic::{ElasticJoint, ElasticJoints, EncoderSide};
pub use frozen::FrozenArm;
pub use gains::{FORMAT, Gains, GainsError, VERSION};
pub use iss::Iss;
pub use joint_limit::JointLimit;
pub use law::UnitLaw;
pub use margins::Margins;
pub use model::LoopModel;
pub use moving::{AnySpeed, Moving, Unstable};
pub use noise::TorqueNoise;
pub use norm::NormH;
pub use not_counted::{LeftOut, NotCounted};
pub use optimality::{Certified, LevelRefused, Optimality};
pub use outward::outward;
pub use paper::PaperRadius;
pub use peak_gain::PeakGain;
pub use peaks::SampledPeaks;
pub use performance::PeakGains;
pub use phi::{Phi, PhiBasis, ReferenceBounds};
pub use range::{OutsideRange, ProvedEnd, RangeProof, RangeStep, RangeUnproved};
pub use reading::ReadingError;
pub use record::{FilterSection, JointRecord, PositionObserver};
pub use reference::ReferenceError;
pub use refutation::Refutation;
pub use settle::{Settle, SettleFrom};
pub use step::LargestStep;
pub use tip::TubeTip;
pub use trade_off::TradeOff;
pub use tube_again::TubeAgain;
pub use tube_document::{Tube, TubeJoint, TubePayloadSet};
pub use tube_kept::{JointKept, JointRun, Left, Quantity, TubeKept, TubeWatch};
pub use varying::{SampledVarying, VaryingWindow};
pub use verdict::{CheckedBound, Verdict};
pub use verified::{Verified, VerifiedStatement};
pub use verified_range::VerifiedRange;
pub use verify::RATIOS;
pub use window::InertiaWindow;
pub use witness::{Proved, Searched, Witness};

/// A small matrix, row by row.
pub type Matrix = Vec<Vec<f64>>;
