//! One search, and what came of it in the worlds to choose by and to be judged in.

use phihat_rivals::Entry;
use serde::{Deserialize, Serialize};

use super::begin::{contained, from_contained, start};
use super::extent::FrontsExtent;
use crate::arm_case::ArmCase;
use crate::error::CompareError;
use crate::protocol::{Assessed, Assessor, Split, Tried, draw};
use crate::tune::AtEnd;

/// A law under one of its names.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law {
    pub(super) entry: &'static Entry,
    /// 1, or 2 for the second name of a law that is held against itself.
    pub(super) stream: u64,
}

impl Law {
    pub(super) fn id(&self) -> String {
        let id = self.entry.card.id;
        if self.stream == 1 { id.to_owned() } else { format!("{id} again") }
    }
}

/// One search of a law.
#[derive(Debug, Clone, Copy)]
pub(super) struct Job {
    /// Place in the plan's laws.
    pub(super) law: usize,
    /// Place in the extent's caps.
    pub(super) cap: usize,
    pub(super) restart: u64,
}

/// What came of a search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Searched {
    /// Values of the law's scalars and of what is free in what it is handed.
    pub(super) values: Vec<f64>,
    /// Over the training worlds, with the margin's trials.
    pub(super) train: Assessed,
    /// Over the worlds to choose by, with the margin's trials.
    pub(super) validation: Assessed,
    /// Evaluations.
    pub(super) evaluations: usize,
    /// The least cost after so many of them, where it fell.
    pub(super) history: Vec<(usize, f64)>,
    /// Rounds, one more than ranges gave way.
    pub(super) rounds: usize,
    /// Ends of ranges that values are at all the same.
    pub(super) at_end: Vec<AtEnd>,
    /// In the worlds to be judged in.
    pub(super) test: Vec<Option<Tried>>,
}

/// What the journal keeps of a search.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Done {
    Searched(Box<Searched>),
    Refused(String),
}

/// Seeds of searches that have nothing to do with each other are this far apart: rounds and restarts inside of a search lie between.
const APART: u64 = 1_000_000;

impl FrontsExtent {
    /// Does one search at a cap.
    pub(super) fn search(
        &self,
        arm: &ArmCase,
        law: Law,
        (cap, restart): (f64, u64),
    ) -> Result<Searched, CompareError> {
        let worlds = |split: Split, place: usize| draw(self.seed, split, self.worlds[place]);
        let assessor = |split: Split, place: usize, margin: bool| {
            Assessor::new(arm, &worlds(split, place), self.span, (cap, margin))
        };
        let (train, validation) =
            (assessor(Split::Train, 0, true)?, assessor(Split::Validation, 1, true)?);
        let entry = law.entry;
        let seed = APART * (1 + restart + 1000 * (law.stream + 10 * self.seed));
        let effort = (self.per_scalar, self.widenings);
        let begin = match contained(entry).filter(|_| restart == 0) {
            Some(inner) => {
                let smaller = arm.free(inner).0;
                let start = start(&smaller, 0, law.stream, self.seed);
                let found = train.search(inner, &start, effort, seed);
                from_contained(&arm.free(entry).0, &smaller, &found.tuned.values)
            }
            None => start(&arm.free(entry).0, restart, law.stream, self.seed),
        };
        let found = train.search(entry, &begin, effort, seed);
        let values = found.tuned.values;
        Ok(Searched {
            train: train.assess(entry, &values),
            validation: validation.assess(entry, &values),
            evaluations: found.tuned.history.len(),
            history: falls(&found.tuned.history),
            rounds: found.rounds,
            at_end: found.at_end,
            test: assessor(Split::Test, 2, false)?.measured(entry, &values),
            values,
        })
    }
}

/// Where the least so far fell: how many evaluations it took, and to what.
fn falls(history: &[f64]) -> Vec<(usize, f64)> {
    let mut least = f64::INFINITY;
    let mut fell = |(count, cost): (usize, &f64)| {
        let falls = *cost < least;
        least = least.min(*cost);
        falls.then_some((count, *cost))
    };
    (1..).zip(history).filter_map(&mut fell).collect()
}

#[cfg(test)]
mod tests {
    use super::falls;

    #[test]
    fn only_what_falls_is_kept() {
        assert_eq!(falls(&[3.0, 4.0, 2.0, 2.0, 2.5, 1.0]), [(1, 3.0), (3, 2.0), (6, 1.0)]);
    }
}
