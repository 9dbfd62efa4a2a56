//! Results of a comparison, as data: `compare.json`.

use phihat_rivals::{Card, Needs, Scalar};
use serde::{Deserialize, Serialize};

use crate::mark::Mark;
use crate::row::LawRow;

/// Value of `format` in every comparison.
pub const FORMAT: &str = "phihat-comparison";

/// The whole answer, `compare.json`: the same bytes for the same plan, however it was run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Always `"phihat-comparison"`.
    pub format: String,
    /// Version of phihat.
    pub phihat_version: String,
    /// The terms, the same for everybody.
    pub fairness: Fairness,
    /// The arms.
    pub arms: Vec<ArmRecord>,
    /// The worlds.
    pub worlds: Vec<WorldRecord>,
    /// The rivals, in the order of the paper's table.
    pub rivals: Vec<RivalRecord>,
    /// One row for each arm and rival, rivals in their order within an arm.
    pub rows: Vec<LawRow>,
}

/// The terms that every rival was tuned and judged on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fairness {
    /// The optimiser, by name.
    pub optimiser: String,
    /// Evaluations that each rival's tuning had on each arm.
    pub tuning_runs: usize,
    /// Largest number of times that ranges are widened, each time for as many evaluations again.
    #[serde(default)]
    pub widenings: usize,
    /// Motions that an evaluation simulates in every world that is tuned in, and their length \[s\].
    pub training: (usize, f64),
    /// The worlds that are tuned in.
    pub training_worlds: Vec<String>,
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
    #[serde(alias = "error_max_rad")]
    pub error_bound_rad: Vec<f64>,
}

/// A world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldRecord {
    /// Its name, `[a-z-]`.
    pub name: String,
    /// Its contents, in one line.
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
    /// Certainty of the published form: A, B, C.
    pub grade: String,
    /// Parts that were reconstructed or stand for something else; empty for grade A.
    pub caveat: String,
    /// The law in few lines.
    pub law: String,
    /// Its inputs.
    pub needs: Needs,
    /// Its inputs, in words.
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
    /// Its meaning.
    pub meaning: String,
    /// The value that it has unless tuned: published, or the one that ran first.
    pub default: f64,
    /// Range for a tuner: `[low, high]`.
    pub range: [f64; 2],
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
    /// Record from a card, the needs and the scalars of a rival.
    pub fn new(card: &Card, needs: Needs, scalars: &[Scalar]) -> Self {
        let marks = |t: phihat_rivals::Ticks| {
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

impl Comparison {
    /// The rows of an arm, in the order of the rivals.
    pub fn rows_of<'a>(&'a self, arm: &'a str) -> impl Iterator<Item = &'a LawRow> {
        self.rows.iter().filter(move |row| row.arm == arm)
    }

    /// A rival by its id.
    pub fn rival(&self, id: &str) -> Option<&RivalRecord> {
        self.rivals.iter().find(|rival| rival.id == id)
    }
}
