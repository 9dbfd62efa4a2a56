//! The rivals of the paper's Table 1, measured on the same arms: `phihat compare`.
//!
//! A [`Plan`] is arms × rivals × worlds × choices of gains × seeds. Every rival is first tuned on every arm by
//! one optimiser ([`tune`]) with one budget, on motions and in a world of its own; then it runs in every
//! [`World`], with default and with tuned gains, on other motions. What comes of it is a [`Comparison`].
//!
//! # Not claimed
//!
//! A ranking. Which row is best depends on the column, and the columns on the arms and worlds chosen here.
#![forbid(unsafe_code)]

mod adapter;
mod case;
mod ground;
mod judge;
mod motion;
mod options;
mod own;
mod page;
mod plan;
mod prepare;
mod promise;
mod record;
mod repeat;
mod row;
mod rows;
mod trial;
mod tune;
mod work;
mod world;

pub use adapter::{Adapter, supply};
pub use ground::{CompareError, Ground};
pub use options::{CompareAnswer, CompareOptions};
pub use page::{
    Beaten, DEFAULTS, Loss, NOT_TUNED, Trial, UNITS, comparison_page, comparison_table, losses,
    main_world, model_free, model_free_in_full, trial_page,
};
pub use plan::{Extent, Plan};
pub use prepare::{LIMITED, NOISE_CAP};
pub use record::{
    ArmRecord, Comparison, FORMAT, Fairness, Mark, RivalRecord, ScalarRecord, WorldRecord,
};
pub use repeat::Repeated;
pub use row::{
    Cell, Columns, ConditionRecord, Cost, Fate, Figures, GainsKind, Measured, Row, Run, Sketch,
    TuningRecord,
};
pub use rows::EASY_SHARES;
pub use trial::NOMINAL_MASSES;
pub use tune::{Tuned, tune};
pub use world::{SATURATION, WORLDS, World, world};
