//! Random arms and studies that try to break a certificate.
//!
//! A [`Trial`] draws an arm and a study as texts, designs and verifies as a user does, runs the study in the worlds of
//! its scope, and holds every sample against what is [`claimed`].
//!
//! # Not claimed
//!
//! That nothing was found is no proof: what is drawn is what [`draw()`] can draw.
#![forbid(unsafe_code)]
#![allow(clippy::disallowed_methods, reason = "an attack tells how long it took")]

mod arm;
mod chain_text;
mod claim;
mod class;
mod class_supervised;
mod derived;
mod draft;
mod draw;
mod draw_positions;
mod draw_reference;
mod drawn;
mod filtered;
mod forge;
mod frozen;
mod hand;
mod held;
mod hostile;
mod judged;
mod link;
mod phase;
mod record;
mod run;
mod second;
mod spectrum;
mod start;
mod summary;
mod trial;
mod typed;
mod vary;

pub use arm::UserArm;
pub use claim::{AttackClaim, JointClaim, NoClaim, claimed};
pub use class::{ClassRuns, class_run};
pub use class_supervised::hostile_run;
pub use draft::{Draft, DraftLaws, DraftLoad, DraftScope, DraftWorld};
pub use draw::draw;
pub use forge::{ForgeError, Forger, ForgeryFate, ForgeryRecord, ForgerySummary};
pub use held::{ClaimOutcome, JointFound, Violation, held};
pub use judged::{DesignVerdict, judged, judged_as_typed};
pub use record::{AttackRecord, TrialEnded};
pub use run::{NoRun, run};
pub use second::SecondOpinion;
pub use summary::AttackSummary;
pub use trial::Trial;
pub use vary::worlds;

pub use phihat_session::Dice;
