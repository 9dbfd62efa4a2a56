//! What is claimed about gains, as data: the gains document and its certificate.
//!
//! This crate finds nothing: whoever checks a claim must not see how it was found.
#![forbid(unsafe_code)]

mod arm;
mod attenuation;
mod bounds;
mod certificate;
mod check;
mod coupled;
mod derive;
#[cfg(test)]
mod dice;
pub mod extremes;
mod gains;
mod iss;
mod law;
mod margins;
mod model;
mod moving;
mod noise;
mod norm;
mod not_counted;
mod optimality;
mod peaks;
mod performance;
mod phi;
mod reading;
mod reference;
mod refutation;
mod replay;
mod settle;
mod step;
mod trade_off;
pub mod tube;
mod tube_again;
mod tube_document;
mod tube_kept;
mod tube_whole;
mod varying;
mod verified;
mod verify;
mod weights;
mod window;
mod witness;

pub use arm::{ArmBasis, ArmInertia};
pub use attenuation::{Attenuation, Interval};
pub use bounds::Bounds;
pub use certificate::{Certificate, ErrorBound, JointCertificate};
pub use coupled::{CoupledGains, FrozenPayload, FrozenPosture};
pub use gains::{FORMAT, Gains, GainsError, JointRecord, VERSION};
pub use iss::Iss;
pub use law::Law;
pub use margins::Margins;
pub use model::{LoopForm, LoopModel, LoopTorque, LoopVelocity};
pub use moving::{Moving, Unstable};
pub use noise::TorqueNoise;
pub use norm::NormH;
pub use not_counted::{LeftOut, NotCounted};
pub use optimality::{Certified, Optimality, Refused};
pub use peaks::SampledPeaks;
pub use performance::{PaperRadius, PeakGain, PeakGains};
pub use phi::{Motion, Phi, PhiBasis};
pub use reading::ReadingError;
pub use reference::ReferenceError;
pub use refutation::Refutation;
pub use settle::{Settle, SettleFrom};
pub use step::LargestStep;
pub use trade_off::TradeOff;
pub use tube_again::TubeAgain;
pub use tube_document::{PayloadSet, Tube, TubeJoint};
pub use tube_kept::{JointKept, JointRun, Left, Quantity, TubeKept, TubeWatch};
pub use varying::{SampledVarying, VaryingWindow};
pub use verified::{Statement, Verified};
pub use verify::RATIOS;
pub use window::InertiaWindow;
pub use witness::{Proved, Searched, Witness};

/// A small matrix, row by row.
pub type Matrix = Vec<Vec<f64>>;
