//! The rivals of the paper's Table 1, measured on the same arms.

mod adapter;
mod record;
mod tune;

pub use adapter::{Adapter, supply};
pub use record::{
    ArmRecord, Cell, Columns, Comparison, ConditionRecord, Cost, FORMAT, Fairness, Fate, Figures,
    GainsKind, Mark, Measured, RivalRecord, Row, Run, ScalarRecord, Sketch, TuningRecord,
    WorldRecord,
};
pub use tune::{Tuned, tune};
