#![doc = include_str!("../README.md")]
//!
//! # Parts
//!
//! The rivals of the paper's Table 1, measured on the same arms: `phihat compare`.
//!
//! A [`ComparisonPlan`] is arms × rivals × worlds × choices of gains × seeds. Every rival is first tuned on every arm
//! by one optimiser ([`tune`]) with one budget, on motions and in a world of its own; then it runs in every
//! [`ComparisonWorld`], with default and with tuned gains, on other motions. What comes of it is a [`Comparison`].
#![forbid(unsafe_code)]

mod adapter;
mod arm_case;
mod arm_in_world;
mod case;
mod columns;
mod cost;
mod error;
mod extent;
mod fairness;
pub mod fronts;
mod judge;
mod mark;
mod motion;
mod options;
mod page;
mod plan;
mod prepare;
mod promise;
mod proposed_claims;
mod proposed_law;
mod proposed_positions;
pub mod protocol;
mod record;
mod repeat;
mod row;
mod rows;
mod run;
mod run_outcome;
mod score;
#[cfg(test)]
mod sure;
mod trial;
mod tune;
mod work;
mod world;

pub use adapter::{Adapter, NOMINAL_MASSES, supply};
pub use arm_case::ArmCase;
pub use columns::EASY_SHARES;
pub use cost::{LIMITED, NOISE_CAP};
pub use error::CompareError;
pub use extent::ComparisonExtent;
pub use mark::Mark;
pub use options::{CompareAnswer, CompareOptions};
pub use page::{
    Beaten, DEFAULTS, LossOfLaw, NOT_TUNED, PageTrial, UNITS, comparison_page, comparison_table,
    losses, main_world, model_free, model_free_in_full, trial_page,
};
pub use plan::ComparisonPlan;
pub use record::{ArmRecord, Comparison, FORMAT, Fairness, RivalRecord, ScalarRecord, WorldRecord};
pub use repeat::Repeated;
pub use row::{
    ConditionRecord, GainsKind, LawCell, LawRow, LawRun, MarkColumns, MeasuredTicks, TuningCost,
    TuningRecord,
};
pub use run_outcome::{Figures, RunOutcome, Sketch};
pub use tune::{AtEnd, Tuned, Widened, tune, tune_widening};
pub use world::{ComparisonWorld, SATURATION, WORLDS, world};
