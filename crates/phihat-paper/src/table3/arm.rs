//! Every run of Table 3 on one arm.

use super::bench::{Bench, LAWS, Score};
use super::robots::{Table3Robot, as_good};
use crate::part::PartError;

/// Runs of the optimiser per law and arm.
pub(super) const RUNS: usize = 40;

/// Gain of the weak comparator, over its default gain.
const WEAK: f64 = 0.25;

/// Default gain of the comparator over the least gain that is tried, and bisection steps between the two.
const LEAST: f64 = 64.0;
const STEPS: u32 = 8;

/// Every run on one arm.
pub(super) struct ArmScores {
    pub(super) bench: Bench,
    /// PD and the proposed law with the same gains, the comparator at its defaults.
    pub(super) stated: Vec<Score>,
    /// The comparator with [`WEAK`] times its gain.
    pub(super) weak: Score,
    /// The proposed law of second order, estimator poles as for the first.
    pub(super) second: Score,
    /// The same gains on robots that compensate by themselves.
    pub(super) robots: Vec<Table3Robot>,
    /// Share of friction left at which PD as (3) is as good on some joint, and that joint; `None`: at none.
    pub(super) as_good: Option<(f64, usize)>,
    /// The largest share of its default gain at which the comparator is worse on every joint.
    pub(super) weak_enough: Option<f64>,
    /// All tuned alike.
    pub(super) fair: Vec<Score>,
    /// Results of the optimiser, law by law.
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
        let (robots, as_good) = (Table3Robot::all(&bench)?, as_good(&bench)?);
        let weak_enough = weak_enough(&bench, &stated[2])?;
        Ok(Self { bench, stated, weak, second, robots, as_good, weak_enough, fair, values })
    }

    pub(super) fn name(&self) -> &'static str {
        self.bench.arm
    }
}

/// The largest share of its default gain, down to a [`LEAST`]th, at which the comparator is worse than `proposed`
/// on every joint; `None`: at none.
fn weak_enough(bench: &Bench, proposed: &Score) -> Result<Option<f64>, PartError> {
    let worse = |share: f64| -> Result<bool, PartError> {
        let comparator = bench.comparator_at(share)?;
        Ok(comparator.square.iter().zip(&proposed.square).all(|(theirs, ours)| theirs > ours))
    };
    let (mut low, mut high) = (1.0 / LEAST, 1.0);
    if worse(high)? {
        return Ok(Some(high));
    }
    if !worse(low)? {
        return Ok(None);
    }
    for _ in 0..STEPS {
        let middle = (low * high).sqrt();
        if worse(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(Some(low))
}
