//! The paper's three-joint arm: Figs. 4 to 11, (50) and order switching, on a surrogate and on others.
//!
//! The studies lie in `studies/paper/`, one per set of gains. Every verdict is computed from their runs: change a
//! study ([`Studies::replaced`]) and it changes.

mod assumptions;
mod claims;
mod errors;
mod experiment;
mod fourth;
mod mismatch;
mod order_switch;
mod path;
mod peaking;
mod phi_hat;
mod run;
mod runs;
mod saturation;
mod simulation;
mod softer;
mod start_map;
mod steady;
mod studies;
mod surrogates;
mod switching;
mod transient;
mod variations;

pub use experiment::experiment;
pub(crate) use run::Run;
pub use run::resized;
pub use simulation::simulation;
pub(crate) use studies::SHIPPED;
pub use studies::{GainSetting, Studies, StudyKind};
pub use switching::order_switching;
