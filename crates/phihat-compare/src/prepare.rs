//! Before the runs that count: tuning, and how forgiving the gains are.

use phihat_rivals::{Entry, Scalar};
use phihat_study::Study;
use serde::{Deserialize, Serialize};

use super::ground::{CompareError, Ground, Task};
use super::judge::{Bars, judge};
use super::plan::Extent;
use super::row::{Fate, Figures, TuningRecord};
use super::trial::{TrialError, run};
use super::tune::tune;
use super::world::TRAINING;
use phihat_session::share;

/// Torque noise that tuned gains may have, over the torque limit: mean step from sample to sample.
pub const NOISE_CAP: f64 = 0.01;

/// Cost of noise at its cap \[rad\]: no error of a quieter run that followed is as large.
const NOISY: f64 = 10.0;

/// Cost of a run that reached its end without following \[rad\], or with torques that met their limits: no noise is as
/// bad.
const LOST: f64 = 500.0;

/// Share of samples at a torque limit beyond which nothing is controlled, where the limits leave room.
pub const LIMITED: f64 = 0.02;

/// Cost of a run that did not reach its end \[rad\], more the sooner it ended: no error of a run that did is as
/// large.
const UNFINISHED: f64 = 1e3;

/// What comes before the runs that count.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum Prepared {
    /// The rival does not apply to this arm or task.
    Refused(String),
    /// Gains, found.
    Tuned(TuningRecord),
    /// Share of draws that kept the specification.
    Drawn(f64),
}

/// What one choice of gains came to on the training motions.
struct Trained {
    /// \[rad\]
    cost: f64,
    /// Whether every motion kept the specification and the cap on noise.
    kept: bool,
}

/// The training motions of an arm, each in every world that is trained in.
pub(crate) fn training(ground: &Ground, extent: &Extent) -> Result<Vec<Study>, CompareError> {
    let span = (extent.training_s, extent.training_settle_s);
    let motions = 1..=extent.training_motions;
    let runs = motions.flat_map(|k| TRAINING.map(|world| (world, k)));
    runs.map(|(world, k)| ground.in_world(world, Task::Train(k), span)).collect()
}

/// Tunes a rival on an arm.
pub(crate) fn tuned(ground: &Ground, entry: &Entry, extent: &Extent) -> Prepared {
    let studies = match training(ground, extent) {
        Ok(studies) => studies,
        Err(e) => return Prepared::Refused(e.to_string()),
    };
    let default: Vec<f64> = entry.scalars.iter().map(|scalar| scalar.default).collect();
    if let Err(e) = train(ground, entry, &default, &studies) {
        return Prepared::Refused(e.to_string());
    }
    let mut kept = Vec::new();
    let tuned = tune(entry.scalars, extent.tuning_runs, 1, |values| {
        let trained = train(ground, entry, values, &studies);
        // Gains that the law itself refuses are the worst there are.
        let trained = trained.unwrap_or(Trained { cost: f64::INFINITY, kept: false });
        kept.push(trained.kept);
        trained.cost
    });
    Prepared::Tuned(TuningRecord {
        default,
        tuned: tuned.values,
        runs: tuned.history.len(),
        cost_default: tuned.history[0],
        cost_tuned: tuned.cost,
        runs_to_spec: kept.iter().position(|kept| *kept).map(|k| k + 1),
    })
}

/// Draws gains within a decade of the default ones, and counts those that keep the specification.
pub(crate) fn drawn(ground: &Ground, entry: &Entry, extent: &Extent) -> Prepared {
    let studies = match training(ground, extent) {
        Ok(studies) => studies,
        Err(e) => return Prepared::Refused(e.to_string()),
    };
    // One motion in every world.
    let first = &studies[..studies.len().min(TRAINING.len())];
    let keeps = |k: &usize| {
        let values: Vec<f64> =
            entry.scalars.iter().map(|scalar| draw(entry.card.id, scalar, *k)).collect();
        train(ground, entry, &values, first).is_ok_and(|trained| trained.kept)
    };
    // Without a free scalar all draws are the same.
    let draws = if entry.scalars.is_empty() { 1 } else { extent.draws.max(1) };
    let count = (0..draws).filter(keeps).count();
    Prepared::Drawn(count as f64 / draws as f64)
}

/// A value within a decade of the default one, even in logarithms, inside its range.
fn draw(id: &str, scalar: &Scalar, k: usize) -> f64 {
    let low = (scalar.default / 10.0).max(scalar.low);
    let high = (scalar.default * 10.0).min(scalar.high);
    let place = share(id, &format!("{} {k}", scalar.name));
    (low * (high / low).powf(place)).clamp(scalar.low, scalar.high)
}

/// Mean cost over the motions.
fn train(
    ground: &Ground,
    entry: &Entry,
    values: &[f64],
    studies: &[Study],
) -> Result<Trained, TrialError> {
    let bars = Bars { error_max: &ground.error_max, limits: &ground.limits, bound: None };
    let mut sum = Trained { cost: 0.0, kept: true };
    for study in studies {
        let trial = run(ground, entry, values, study)?;
        let (fate, figures) = judge(study, &trial.outcome, trial.broken, &bars);
        sum.cost += cost(study, &fate, figures.as_ref()) / studies.len() as f64;
        sum.kept &= fate.followed()
            && figures.is_some_and(|f| f.error_over_spec <= 1.0 && f.noise <= NOISE_CAP);
    }
    Ok(sum)
}

/// The error where the noise keeps its cap; how far it is beyond where not; above that, the error of a run that did
/// not follow, or lived on its torque limits; above all, how soon it ended where it did.
fn cost(study: &Study, fate: &Fate, figures: Option<&Figures>) -> f64 {
    match (fate, figures) {
        (fate, Some(figures)) if !fate.followed() || figures.saturated > LIMITED => {
            (LOST + figures.error_rms_rad).min(UNFINISHED)
        }
        (_, Some(figures)) if figures.noise <= NOISE_CAP => figures.error_rms_rad.min(NOISY),
        (_, Some(figures)) => (NOISY * figures.noise / NOISE_CAP).min(LOST),
        (Fate::Diverged { t, .. } | Fate::NotFinite { t, .. }, None) => {
            UNFINISHED * (2.0 - t / study.duration)
        }
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests: a panic is the report")]

    use super::{Fate, Figures, NOISE_CAP, Study, cost};

    /// However large the error and however small the noise: following comes before quiet, quiet before exact.
    #[test]
    fn gains_that_do_not_follow_are_worse_than_noise_and_better_than_an_early_end() {
        let text = "duration_s = 4.0\n[robot]\nname = \"planar3r\"\n[design]\n[reference]\nkind = \"hold\"\npose = \"ready\"\n";
        let study = Study::from_text(text, "cost.toml", std::path::Path::new(".")).unwrap();
        let run = |error_rms_rad: f64, noise: f64, saturated: f64| Figures {
            error_rms_rad,
            error_max_rad: error_rms_rad,
            error_over_spec: 1.0,
            effort: 0.1,
            chatter_nm: 0.0,
            chatter_over_exact: None,
            noise,
            saturated,
            recovery_s: None,
            bound_rad: None,
            bound_over_measured: None,
        };
        let lost = Fate::Lost { joint: "joint1".to_owned() };
        let ended = Fate::Diverged { t: 3.9, joint: "joint1".to_owned() };
        let ladder = [
            (&Fate::Followed, Some(run(1e-4, 0.5 * NOISE_CAP, 0.0))),
            (&Fate::Followed, Some(run(1e-2, NOISE_CAP, 0.01))),
            (&Fate::Followed, Some(run(1e-6, 2.0 * NOISE_CAP, 0.0))),
            (&Fate::Followed, Some(run(1e-6, 9.0 * NOISE_CAP, 0.0))),
            (&Fate::Followed, Some(run(1e-6, 0.0, 0.5))),
            (&lost, Some(run(0.8, 0.0, 0.0))),
            (&ended, None),
        ];
        let costs: Vec<f64> =
            ladder.iter().map(|(fate, figures)| cost(&study, fate, figures.as_ref())).collect();
        assert!(costs.windows(2).all(|pair| pair[0] < pair[1]), "{costs:?}");
    }
}
