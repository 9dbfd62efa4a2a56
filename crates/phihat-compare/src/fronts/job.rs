//! One search, and its results in the validation and the test worlds.

use phihat_rivals::Entry;
use serde::{Deserialize, Serialize};

use super::begin::{contained, from_contained, start};
use super::extent::FrontsExtent;
use crate::arm_case::ArmCase;
use crate::error::CompareError;
use crate::protocol::{Assessed, AssessedRun, Assessor, BestOfCap, Split, draw};
use crate::tune::AtEnd;

/// A law under one of its names.
#[derive(Debug, Clone, Copy)]
pub(super) struct NamedLaw {
    pub(super) entry: &'static Entry,
    /// 1, or 2 for the second name of a law that is compared with itself.
    pub(super) stream: u64,
}

impl NamedLaw {
    pub(super) fn id(&self) -> String {
        let id = self.entry.card.id;
        if self.stream == 1 { id.to_owned() } else { format!("{id} again") }
    }
}

/// One search of a law, under all caps.
#[derive(Debug, Clone, Copy)]
pub(super) struct Job {
    /// Place in the plan's laws.
    pub(super) law: usize,
    pub(super) restart: u64,
}

/// Result of a search under one cap.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SearchedLaw {
    /// Values of the law's scalars and of the free choices in its inputs.
    pub(super) values: Vec<f64>,
    /// Over the training worlds, with the margin's trials.
    pub(super) train: Assessed,
    /// Over the worlds to choose by, with the margin's trials.
    pub(super) validation: Assessed,
    /// Evaluations of the search, under all caps.
    pub(super) evaluations: usize,
    /// The least cost after so many of them, where it fell.
    pub(super) history: Vec<(usize, f64)>,
    /// Number of times that ranges were widened.
    pub(super) widened: usize,
    /// Ends of ranges that values are at all the same.
    pub(super) at_end: Vec<AtEnd>,
    /// In the worlds to be judged in.
    pub(super) test: Vec<Option<AssessedRun>>,
}

/// Record of a search in the journal.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum JobRecord {
    /// One per cap, in their order.
    Searched(Vec<SearchedLaw>),
    Refused(String),
}

/// Distance between the seeds of independent searches: the rounds and restarts of one search lie between.
const APART: u64 = 1_000_000;

impl FrontsExtent {
    /// Does one search; returns its results in the order of the caps.
    pub(super) fn search(
        &self,
        arm: &ArmCase,
        law: NamedLaw,
        restart: u64,
    ) -> Result<Vec<SearchedLaw>, CompareError> {
        let loosest = self.caps.iter().copied().reduce(f64::max);
        let assessor = |split: Split, place: usize, margin: Option<f64>| {
            Assessor::new(arm, &draw(self.seed, split, self.worlds[place]), self.span, margin)
        };
        let train = assessor(Split::Train, 0, loosest)?;
        let validation = assessor(Split::Validation, 1, loosest)?;
        let test = assessor(Split::Test, 2, None)?;
        let entry = law.entry;
        let seed = APART * (1 + restart + 1000 * (law.stream + 10 * self.seed));
        let effort = (self.per_scalar, self.widenings);
        let starts = match contained(entry).filter(|_| restart == 0) {
            Some(inner) => {
                let (outer, smaller) = (arm.free(entry).0, arm.free(inner).0);
                let begin = start(&smaller, 0, law.stream, self.seed);
                let found = train.search(inner, &[begin], &self.caps, effort, seed);
                found.iter().map(|best| from_contained(&outer, &smaller, &best.values)).collect()
            }
            None => vec![start(&arm.free(entry).0, restart, law.stream, self.seed)],
        };
        let found = train.search(entry, &starts, &self.caps, effort, seed);
        let searched = |(best, cap): (BestOfCap, &f64)| SearchedLaw {
            train: best.assessed,
            validation: validation.assay(entry, &best.values).at(*cap),
            test: test.measured(entry, &best.values),
            evaluations: best.evaluations,
            history: best.history,
            widened: best.widened,
            at_end: best.at_end,
            values: best.values,
        };
        Ok(found.into_iter().zip(&self.caps).map(searched).collect())
    }
}
