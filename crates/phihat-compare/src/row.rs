//! A row of the comparison, as data: one rival on one arm.

use serde::{Deserialize, Serialize};

use super::record::Mark;

/// What one rival came to on one arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The arm's name.
    pub arm: String,
    /// The rival's id.
    pub rival: String,
    /// Why it has no cells: the law does not apply to this arm or task.
    pub refused: Option<String>,
    /// The gains it ran with, and how they were found; `None` where refused.
    pub tuning: Option<TuningRecord>,
    /// The four columns, in the paper's order.
    pub columns: Option<Columns>,
    /// What an update costs; `None` where refused.
    pub cost: Option<Cost>,
    /// One for each world and choice of gains, worlds in their order, default before tuned.
    pub cells: Vec<Cell>,
}

/// Gains and how they were found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TuningRecord {
    /// The law's default values, in the order of the scalars.
    pub default: Vec<f64>,
    /// Tuned values.
    pub tuned: Vec<f64>,
    /// Evaluations that were spent: the same for every rival with a free scalar.
    pub runs: usize,
    /// Cost of the default gains: rms error \[rad\] of the worst joint where nothing is penalised.
    pub cost_default: f64,
    /// Cost of the tuned gains.
    pub cost_tuned: f64,
    /// The first evaluation, from 1, that kept the specification on the training motions.
    pub runs_to_spec: Option<usize>,
}

/// The paper's four columns, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Columns {
    /// Quantitative performance: a bound stated before the run, and whether it held.
    pub quantitative: Measured,
    /// Easy tuning: how much of the gains' neighbourhood does.
    pub easy: Measured,
    /// Optimal: a certificate verified for the tuned gains.
    pub optimal: Measured,
    /// Model free, by type.
    pub model_free: Measured,
    /// Share of draws of gains within a decade of the default ones that keep the specification.
    pub share_of_draws: f64,
    /// Number of free scalars.
    pub scalars: usize,
    /// The law's own stability condition at the tuned gains, where it has one.
    pub condition: Option<ConditionRecord>,
}

/// One column of one row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// What was measured.
    pub mark: Mark,
    /// What the paper prints.
    pub printed: Option<Mark>,
    /// Whether they are the same; `None` where the paper prints nothing.
    pub agrees: Option<bool>,
    /// Why, in one sentence with figures.
    pub why: String,
}

/// A stability condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConditionRecord {
    /// The condition.
    pub text: String,
    /// Whether it holds.
    pub holds: bool,
    /// Left side over right side: above 1 it holds; `None` where it is not a finite number.
    pub margin: Option<f64>,
}

/// What an update costs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Scalars remembered from one sample to the next.
    pub states: usize,
    /// Instructions per update with default gains, where they were counted on this robot.
    pub instructions: Option<u64>,
}

/// Which gains a cell was run with.
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
pub struct Cell {
    /// The world's name.
    pub world: String,
    /// Which gains.
    pub gains: GainsKind,
    /// Every seed, from 1.
    pub runs: Vec<Run>,
    /// The worst over seeds, figure by figure; `None` where no run has figures.
    pub worst: Option<Figures>,
    /// The worst fate over seeds.
    pub fate: Fate,
    /// The trace of seed 1; `None` where there is none.
    pub sketch: Option<Sketch>,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Its name, `ARM/RIVAL/WORLD/default|tuned/SEED`: the command repeats it.
    pub name: String,
    /// Seed.
    pub seed: u64,
    /// What became of it.
    pub fate: Fate,
    /// Its figures; `None` unless it ran to its end.
    pub figures: Option<Figures>,
}

/// What became of a run, from good to bad.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// It followed its reference.
    Followed,
    /// It ran to its end, but an error of some joint came to half of that joint's motion: it did not follow.
    Lost {
        /// The joint.
        joint: String,
    },
    /// The arm's state left every plausible range.
    Diverged {
        /// When \[s\].
        t: f64,
        /// The joint.
        joint: String,
    },
    /// The rival gave a torque that is no number.
    NotFinite {
        /// When first \[s\].
        t: f64,
        /// The joint.
        joint: String,
    },
    /// It could not be built or run; why.
    Refused(String),
    /// The program panicked: a fault of this program.
    Panicked(String),
}

/// Figures of a run after `settle_s`; of the worst joint where they are per joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Root mean square of `e` \[rad\].
    pub error_rms_rad: f64,
    /// Largest |e| \[rad\].
    pub error_max_rad: f64,
    /// Largest |e| over the specification's: up to 1 it is kept.
    pub error_over_spec: f64,
    /// Root mean square of the applied torque over the joint's limit.
    pub effort: f64,
    /// Mean |τ_k − τ_{k−1}| of the commanded torque \[N·m\].
    pub chatter_nm: f64,
    /// The same over the same rival's in the exact world with the same gains and seed.
    pub chatter_over_exact: Option<f64>,
    /// Mean |τ_k − 2τ_{k−1} + τ_{k−2}|/√3 over the joint's torque limit: what white noise of the torque
    /// has as mean step, without what the motion asks for.
    pub noise: f64,
    /// Share of samples in which a joint's torque met its limit.
    pub saturated: f64,
    /// From the end of the last push until every |e| stays inside the larger of its specification and twice what
    /// it was before the push \[s\]; `None`: no push, or it did not come back.
    pub recovery_s: Option<f64>,
    /// The bound stated before the run, of the joint whose measured error comes closest to it \[rad\].
    pub bound_rad: Option<f64>,
    /// The smallest bound/measured over the joints: below 1 the bound was broken.
    pub bound_over_measured: Option<f64>,
}

/// A trace in few numbers: smallest and largest in equal slices of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sketch {
    /// The joint: the one with the largest error.
    pub joint: String,
    /// End of the last slice \[s\]; the first begins at 0.
    pub end_s: f64,
    /// `e` \[rad\], `[smallest, largest]` per slice.
    pub e_rad: Vec<[f32; 2]>,
    /// Commanded torque \[N·m\], likewise.
    pub tau_nm: Vec<[f32; 2]>,
}

impl Fate {
    /// Whether the run followed its reference.
    pub fn followed(&self) -> bool {
        *self == Self::Followed
    }

    /// From 0, good, to 5, bad.
    pub fn badness(&self) -> u8 {
        match self {
            Self::Followed => 0,
            Self::Lost { .. } => 1,
            Self::Diverged { .. } => 2,
            Self::NotFinite { .. } => 3,
            Self::Refused(_) => 4,
            Self::Panicked(_) => 5,
        }
    }
}

impl Row {
    /// The cell of a world and a choice of gains.
    pub fn cell(&self, world: &str, gains: GainsKind) -> Option<&Cell> {
        self.cells.iter().find(|cell| cell.world == world && cell.gains == gains)
    }
}
