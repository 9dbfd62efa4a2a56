//! Claims about the continuous law of one joint: optimality, input-to-state stability, performance.
//!
//! A claim is plain data that holds its evidence. Its constructor may use any solver; its `verify` recomputes
//! everything from the gains with the small arithmetic of [`matrix`] and [`polynomial`], and returns the
//! inequality that fails, with both sides.
//!
//! # Not claimed
//!
//! `verify` works in double precision with margins for rounding, not in interval arithmetic. Nothing
//! here knows about sampling, delay, saturation, or an inertia that varies in time.

pub mod attenuation;
pub mod h_infinity;
pub mod iss;
pub mod law;
pub mod least_by_40;
pub mod matrix;
pub mod optimality;
pub mod paper;
pub mod performance;
pub mod polynomial;
pub mod response;
pub mod times;
pub mod weights;

pub use attenuation::{Attenuation, Interval};
pub use h_infinity::NormH;
pub use iss::Iss;
pub use law::{Refutation, UnitLaw};
pub use least_by_40::{RadiusGains, RadiusRow};
pub use optimality::{Certified, LevelRefused, Optimality};
pub use paper::{ErrorLimits, MinimalGains, PaperError};
pub use performance::{PaperRadius, PeakGain, PeakGains, WorstCase};
pub use weights::WeightCondition;
