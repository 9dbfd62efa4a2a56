//! Every run of Table 3 on one arm.

use super::bench::{Bench, LAWS, Score};
use crate::part::PartError;

/// Runs of the optimiser per law and arm.
pub(super) const RUNS: usize = 40;

/// What a comparator of a weaker hand is given, over its default gains.
const WEAK: f64 = 0.25;

/// Every run on one arm.
pub(super) struct ArmScores {
    pub(super) bench: Bench,
    /// PD and the proposed law with the same gains, the comparator at its defaults.
    pub(super) stated: Vec<Score>,
    /// The comparator with [`WEAK`] times its gain.
    pub(super) weak: Score,
    /// The proposed law of second order, estimator poles as for the first.
    pub(super) second: Score,
    /// All tuned alike.
    pub(super) fair: Vec<Score>,
    /// What the optimiser found.
    pub(super) values: Vec<Vec<f64>>,
}

impl ArmScores {
    pub(super) fn of(bench: Bench, mut done: impl FnMut()) -> Result<Self, PartError> {
        let (mut stated, mut fair, mut values) = (Vec::new(), Vec::new(), Vec::new());
        for (id, _) in LAWS {
            stated.push(bench.at_stated(id)?);
            let tuned = bench.tuned(id, RUNS)?;
            fair.push(bench.score(id, &tuned)?);
            values.push(tuned);
            done();
        }
        let (weak, second) = (bench.comparator_at(WEAK)?, bench.at_stated("proposed-2")?);
        Ok(Self { bench, stated, weak, second, fair, values })
    }

    pub(super) fn name(&self) -> &'static str {
        self.bench.arm
    }
}
