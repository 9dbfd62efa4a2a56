//! Before the runs that count: tuning, and how forgiving the gains are.

use phihat_rivals::{Entry, Scalar};
use phihat_study::Study;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::arm_case::ArmCase;
use crate::arm_in_world::ComparisonTask;
use crate::cost::{NOISE_CAP, cost};
use crate::error::CompareError;
use crate::extent::ComparisonExtent;
use crate::judge::{Bars, judge};
use crate::row::TuningRecord;
use crate::trial::{TrialError, built, run_many};
use crate::tune::{Widened, tune_widening};
use crate::world::TRAINING;
use phihat_session::share;

/// Result of a preparation for the runs that count.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum PreparedArm {
    /// The rival does not apply to this arm or task.
    Refused(String),
    /// Gains, found.
    Tuned(TuningRecord),
    /// Share of draws that kept the specification.
    Drawn(f64),
}

/// Why a rival has no gains on an arm. A comparison records it as the refusal of the row.
#[derive(Debug, Clone, PartialEq, Error)]
pub(crate) enum Untuned {
    /// Its tuning was not done.
    #[error("it was not tuned")]
    NotDone,
    /// It does not apply; why, as the journal has it.
    #[error("{0}")]
    Refused(String),
    /// Its tuning ended in a panic: a fault of this program.
    #[error("the program panicked: {0}")]
    Panicked(String),
}

/// Tuning of a rival on an arm, and its share of draws, before the runs that count.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Preparation {
    pub(crate) tuning: Result<TuningRecord, Untuned>,
    pub(crate) share: f64,
}

/// The result of one choice of gains on the training motions.
struct Trained {
    /// \[rad\]
    cost: f64,
    /// True if every motion satisfied the specification and the cap on noise.
    kept: bool,
}

/// The training motions of an arm, each in every world that is trained in.
pub(crate) fn training(
    arm: &ArmCase,
    extent: &ComparisonExtent,
) -> Result<Vec<Study>, CompareError> {
    let span = (extent.training_s, extent.training_settle_s);
    let motions = 1..=extent.training_motions;
    let runs = motions.flat_map(|k| TRAINING.map(|world| (world, k)));
    runs.map(|(world, k)| arm.in_world(world, ComparisonTask::Train(k), span)).collect()
}

/// Tunes a rival on an arm.
pub(crate) fn tuned(arm: &ArmCase, entry: &Entry, extent: &ComparisonExtent) -> PreparedArm {
    let studies = match training(arm, extent) {
        Ok(studies) => studies,
        Err(e) => return PreparedArm::Refused(e.to_string()),
    };
    let default: Vec<f64> = entry.scalars.iter().map(|scalar| scalar.default).collect();
    if let Err(e) = train(arm, entry, &default, &studies) {
        return PreparedArm::Refused(e.to_string());
    }
    let mut kept = Vec::new();
    let budget = (extent.tuning_runs, extent.widenings);
    let Widened { tuned, rounds, ranges, at_end } =
        tune_widening(entry.scalars, budget, 1, |values| {
            let trained = train(arm, entry, values, &studies);
            // Gains that the law itself refuses are the worst there are.
            let trained = trained.unwrap_or(Trained { cost: f64::INFINITY, kept: false });
            kept.push(trained.kept);
            trained.cost
        });
    PreparedArm::Tuned(TuningRecord {
        default,
        tuned: tuned.values,
        runs: tuned.history.len(),
        rounds,
        ranges,
        at_end,
        cost_default: tuned.history[0],
        cost_tuned: tuned.cost,
        runs_to_spec: kept.iter().position(|kept| *kept).map(|k| k + 1),
    })
}

/// Draws gains within a decade of the default ones, and counts those that keep the specification.
pub(crate) fn drawn(arm: &ArmCase, entry: &Entry, extent: &ComparisonExtent) -> PreparedArm {
    let studies = match training(arm, extent) {
        Ok(studies) => studies,
        Err(e) => return PreparedArm::Refused(e.to_string()),
    };
    // One motion in every world.
    let first = &studies[..studies.len().min(TRAINING.len())];
    let keeps = |k: &usize| {
        let values: Vec<f64> =
            entry.scalars.iter().map(|scalar| draw(entry.card.id, scalar, *k)).collect();
        train(arm, entry, &values, first).is_ok_and(|trained| trained.kept)
    };
    // Without a free scalar all draws are the same.
    let draws = if entry.scalars.is_empty() { 1 } else { extent.draws.max(1) };
    let count = (0..draws).filter(keeps).count();
    PreparedArm::Drawn(count as f64 / draws as f64)
}

/// A value within a decade of the default one, even in logarithms, inside its range.
fn draw(id: &str, scalar: &Scalar, k: usize) -> f64 {
    let low = (scalar.default / 10.0).max(scalar.low);
    let high = (scalar.default * 10.0).min(scalar.high);
    let place = share(id, &format!("{} {k}", scalar.name));
    (low * (high / low).powf(place)).clamp(scalar.low, scalar.high)
}

/// Mean cost over the motions, which run side by side.
fn train(
    arm: &ArmCase,
    entry: &Entry,
    values: &[f64],
    studies: &[Study],
) -> Result<Trained, TrialError> {
    let bars = Bars { error_bound: &arm.error_bound, limits: &arm.limits, bound: None };
    let mut each: Vec<Result<Trained, TrialError>> = Vec::new();
    each.resize_with(studies.len(), || Ok(Trained { cost: 0.0, kept: true }));
    let made = |_: usize, study: &Study| built(arm, entry, values, study);
    run_many(entry, &arm.units, studies.iter(), made, |place, study, trial| {
        each[place] = trial.map(|trial| {
            let (outcome, figures) = judge(study, &trial.outcome, trial.broken, &bars);
            let cost = cost(study, &outcome, figures.as_ref());
            let kept = outcome.followed()
                && figures.is_some_and(|f| f.error_over_spec <= 1.0 && f.noise <= NOISE_CAP);
            Trained { cost, kept }
        });
    });
    let mut sum = Trained { cost: 0.0, kept: true };
    for trained in each {
        let Trained { cost, kept } = trained?;
        sum.cost += cost / studies.len() as f64;
        sum.kept &= kept;
    }
    Ok(sum)
}
