//! A row of the comparison, as data: one rival on one arm.

use serde::{Deserialize, Serialize};

use crate::mark::Mark;
use crate::run_outcome::{Figures, RunOutcome, Sketch};
use crate::tune::AtEnd;

/// The results of one rival on one arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LawRow {
    /// The arm's name.
    pub arm: String,
    /// The rival's id.
    pub rival: String,
    /// Why it has no cells: the law does not apply to this arm or task.
    pub refused: Option<String>,
    /// The gains it ran with, and how they were found; `None` where refused.
    pub tuning: Option<TuningRecord>,
    /// The four columns, in the paper's order.
    pub columns: Option<MarkColumns>,
    /// Cost of an update; `None` where refused.
    pub cost: Option<TuningCost>,
    /// One for each world and choice of gains, worlds in their order, default before tuned.
    pub cells: Vec<LawCell>,
}

/// Gains and how they were found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TuningRecord {
    /// The law's default values, in the order of the scalars.
    pub default: Vec<f64>,
    /// Tuned values.
    pub tuned: Vec<f64>,
    /// Evaluations that were spent: the same for every rival with a free scalar, for each of its rounds.
    pub runs: usize,
    /// Searches: one more than ranges were widened for.
    #[serde(default = "one")]
    pub rounds: usize,
    /// The ranges of the last one: `[low, high]` in the order of the scalars. Empty in documents of before.
    #[serde(default)]
    pub ranges: Vec<[f64; 2]>,
    /// The ends of ranges at which tuned values still are.
    #[serde(default)]
    pub at_end: Vec<AtEnd>,
    /// Cost of the default gains: rms error \[rad\] of the worst joint where nothing is penalised.
    pub cost_default: f64,
    /// Cost of the tuned gains.
    pub cost_tuned: f64,
    /// The first evaluation, from 1, that kept the specification on the training motions.
    pub runs_to_spec: Option<usize>,
}

const fn one() -> usize {
    1
}

/// The paper's four columns, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MarkColumns {
    /// Quantitative performance: a bound stated before the run, and whether it held.
    pub quantitative: MeasuredTicks,
    /// Easy tuning: how much of the gains' neighbourhood does.
    pub easy: MeasuredTicks,
    /// Optimal: a certificate verified for the tuned gains.
    pub optimal: MeasuredTicks,
    /// Model free, by type.
    pub model_free: MeasuredTicks,
    /// Share of draws of gains within a decade of the default ones that keep the specification.
    pub share_of_draws: f64,
    /// Number of free scalars.
    pub scalars: usize,
    /// The law's own stability condition at the tuned gains, where it has one.
    pub condition: Option<ConditionRecord>,
}

/// One column of one row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredTicks {
    /// Measured mark.
    pub mark: Mark,
    /// Mark that the paper prints.
    pub printed: Option<Mark>,
    /// True if they are the same; `None` where the paper prints nothing.
    pub agrees: Option<bool>,
    /// Why, in one sentence with figures.
    pub why: String,
}

/// A stability condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConditionRecord {
    /// The condition.
    pub text: String,
    /// True if it is satisfied.
    pub holds: bool,
    /// Left side over right side: above 1 it holds; `None` where it is not a finite number.
    pub margin: Option<f64>,
}

/// Cost of an update.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TuningCost {
    /// Scalars remembered from one sample to the next.
    pub states: usize,
    /// Instructions per update with default gains, where they were counted on this robot.
    pub instructions: Option<u64>,
}

/// Choice of gains of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GainsKind {
    /// The law's default ones: published where they were found, else those that ran first.
    Default,
    /// The tuned ones.
    Tuned,
}

/// One rival in one world with one choice of gains, over all seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LawCell {
    /// The world's name.
    pub world: String,
    /// Choice of gains.
    pub gains: GainsKind,
    /// Every seed, from 1.
    pub runs: Vec<LawRun>,
    /// The worst over seeds, figure by figure; `None` where no run has figures.
    pub worst: Option<Figures>,
    /// The worst outcome over seeds.
    #[serde(rename = "fate")]
    pub outcome: RunOutcome,
    /// The trace of seed 1; `None` where there is none.
    pub sketch: Option<Sketch>,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LawRun {
    /// Its name, `ARM/RIVAL/WORLD/default|tuned/SEED`: the command repeats it.
    pub name: String,
    /// Seed.
    pub seed: u64,
    /// Outcome of the run.
    #[serde(rename = "fate")]
    pub outcome: RunOutcome,
    /// Its figures; `None` unless it ran to its end.
    pub figures: Option<Figures>,
}

impl LawRow {
    /// The cell of a world and a choice of gains.
    pub fn cell(&self, world: &str, gains: GainsKind) -> Option<&LawCell> {
        self.cells.iter().find(|cell| cell.world == world && cell.gains == gains)
    }
}
