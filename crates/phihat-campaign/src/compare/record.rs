//! What a comparison leaves, as data: `compare.json`.

use phihat_baselines::{Card, Needs, Scalar, Tick};
use serde::{Deserialize, Serialize};

/// What `format` says in every comparison.
pub const FORMAT: &str = "phihat-comparison";

/// The whole answer, `compare.json`: the same bytes for the same plan, however it was run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Always `"phihat-comparison"`.
    pub format: String,
    /// Version of phihat.
    pub phihat_version: String,
    /// The same terms for everybody.
    pub fairness: Fairness,
    /// The arms.
    pub arms: Vec<ArmRecord>,
    /// The worlds.
    pub worlds: Vec<WorldRecord>,
    /// The rivals, in the order of the paper's table.
    pub rivals: Vec<RivalRecord>,
    /// One row for each arm and rival, rivals in their order within an arm.
    pub rows: Vec<Row>,
}

/// The terms that every rival was tuned and judged on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fairness {
    /// The optimiser, by name.
    pub optimiser: String,
    /// Evaluations that each rival's tuning had on each arm.
    pub tuning_runs: usize,
    /// Motions that an evaluation simulates, and their length \[s\].
    pub training: (usize, f64),
    /// The world that is tuned in.
    pub training_world: String,
    /// Motions that are scored on in every world: the study's own, and drawn ones; none of the training.
    pub seeds: u64,
    /// Length of a scored run \[s\]; the first part, up to the study's `settle_s`, is not scored.
    pub scored_s: f64,
    /// Link masses of the nominal model that model-based rivals are given, over the arm's.
    pub nominal_masses: f64,
    /// Torque noise that tuned gains may have, over the joint's torque limit.
    pub noise_cap: f64,
    /// Draws of gains for the share that keeps the specification.
    pub draws: usize,
    /// Paragraphs for people: how it was done, and what it does not show.
    pub notes: Vec<String>,
}

/// An arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ArmRecord {
    /// The study's name.
    pub name: String,
    /// The robot's name.
    pub robot: String,
    /// The study's file, as it was named.
    pub study: String,
    /// SHA-256 of its text.
    pub study_sha256: String,
    /// The joints' names.
    pub joints: Vec<String>,
    /// `U` \[kg·m²\] per joint: unit of every rival's torque gains, and `M̄` of those that know it.
    pub inertia: Vec<f64>,
    /// The specification's largest |e| \[rad\] per joint.
    pub error_max_rad: Vec<f64>,
}

/// A world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldRecord {
    /// Its name, `[a-z-]`.
    pub name: String,
    /// What is in it, in one line.
    pub what: String,
}

/// A rival, as its card states it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RivalRecord {
    /// Short name, `[a-z0-9-]`.
    pub id: String,
    /// Name for people.
    pub title: String,
    /// The paper's reference number, or nothing.
    pub reference: String,
    /// Authors, title, year of the source.
    pub source: String,
    /// How certain the published form is: A, B, C.
    pub grade: String,
    /// What was reconstructed or stands for something else; empty for grade A.
    pub caveat: String,
    /// The law in few lines.
    pub law: String,
    /// What it is handed.
    pub needs: Needs,
    /// The same in words.
    pub needs_words: String,
    /// Its free scalars.
    pub scalars: Vec<ScalarRecord>,
    /// The paper's ticks: quantitative, easy, optimal, model-free; `None`: the paper has no row.
    pub printed: Option<[Mark; 4]>,
}

/// A free scalar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScalarRecord {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// What it does.
    pub meaning: String,
    /// Published value.
    pub default: f64,
    /// What a tuner may try: `[low, high]`.
    pub range: [f64; 2],
}

/// A tick, printed or measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// ✓
    Yes,
    /// ✗
    No,
    /// –
    Partly,
}

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
    /// One for each world and choice of gains, worlds in their order, published before tuned.
    pub cells: Vec<Cell>,
}

/// Gains and how they were found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TuningRecord {
    /// Published values, in the order of the scalars.
    pub published: Vec<f64>,
    /// Tuned values.
    pub tuned: Vec<f64>,
    /// Evaluations that were spent: the same for every rival with a free scalar.
    pub runs: usize,
    /// Cost of the published gains: rms error \[rad\] of the worst joint where nothing is penalised.
    pub cost_published: f64,
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
    /// Share of draws of gains within a decade of the published ones that keep the specification.
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
    /// Instructions per update, where they were counted.
    pub instructions: Option<u64>,
}

/// Which gains a cell was run with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GainsKind {
    /// The published ones.
    Published,
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
    /// Its name, `ARM/RIVAL/WORLD/published|tuned/SEED`: the command repeats it.
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

impl From<Tick> for Mark {
    fn from(tick: Tick) -> Self {
        match tick {
            Tick::Yes => Self::Yes,
            Tick::No => Self::No,
            Tick::Partly => Self::Partly,
        }
    }
}

impl From<&Scalar> for ScalarRecord {
    fn from(scalar: &Scalar) -> Self {
        Self {
            name: scalar.name.to_owned(),
            unit: scalar.unit.to_owned(),
            meaning: scalar.meaning.to_owned(),
            default: scalar.default,
            range: [scalar.low, scalar.high],
        }
    }
}

impl RivalRecord {
    /// What a card, the needs and the scalars of a rival say.
    pub fn new(card: &Card, needs: Needs, scalars: &[Scalar]) -> Self {
        let marks = |t: phihat_baselines::Ticks| {
            [t.quantitative, t.easy, t.optimal, t.model_free].map(Mark::from)
        };
        Self {
            id: card.id.to_owned(),
            title: card.title.to_owned(),
            reference: card.reference.to_owned(),
            source: card.source.to_owned(),
            grade: format!("{:?}", card.grade),
            caveat: card.caveat.to_owned(),
            law: card.law.to_owned(),
            needs,
            needs_words: needs.to_string(),
            scalars: scalars.iter().map(ScalarRecord::from).collect(),
            printed: card.printed.map(marks),
        }
    }
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

impl Comparison {
    /// The rows of an arm, in the order of the rivals.
    pub fn rows_of<'a>(&'a self, arm: &'a str) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |row| row.arm == arm)
    }

    /// A rival by its id.
    pub fn rival(&self, id: &str) -> Option<&RivalRecord> {
        self.rivals.iter().find(|rival| rival.id == id)
    }
}
