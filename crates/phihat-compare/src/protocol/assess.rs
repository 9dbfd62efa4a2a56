//! A candidate, tried in drawn worlds: what its error is, and which constraints it breaks.

use std::borrow::Cow;

use phihat_rivals::{Chosen, Entry, Scalar, Tuning};
use phihat_session::Dice;
use phihat_study::Study;
use serde::{Deserialize, Serialize};

use super::feasible::Assessed;
use super::margin::Harder;
use super::worlds::Drawn;
use crate::adapter::supply;
use crate::arm_case::ArmCase;
use crate::cost::LIMITED;
use crate::error::CompareError;
use crate::judge::{Bars, judge};
use crate::run_outcome::{Figures, RunOutcome};
use crate::trial::{Trial, TrialError, run_many};
use crate::tune::{Widened, tune_widening_from};

/// Evaluations of one search, for each of a law's free scalars and one more.
pub const PER_SCALAR: usize = 200;

/// Errors below this \[rad\] are alike: a microradian is less than an encoder of 22 bits sees.
const LEAST: f64 = 1e-6;

/// What a run that followed measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    /// Root mean square of the error of the worst joint \[rad\]; a microradian at least.
    pub error_rms_rad: f64,
    /// Root mean square of the torque above 50 Hz over its limit, of the worst joint.
    pub noise: f64,
}

/// Where candidates are tried, and under which cap.
#[derive(Debug, Clone)]
pub struct Assessor<'a> {
    arm: &'a ArmCase,
    /// Each world with the masses of the model that laws are handed there: as it is, and with what a margin asks for.
    worlds: Vec<(f64, Study, Vec<Study>)>,
    cap: f64,
}

impl<'a> Assessor<'a> {
    /// For drawn worlds of a length \[s\] whose score begins at `span.1`, a cap on noise above 50 Hz over the torque limit, and with or
    /// without the trials of the margin.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: the arm's study does not bear a world.
    pub fn new(
        arm: &'a ArmCase,
        drawn: &[Drawn],
        span: (f64, f64),
        (cap, margin): (f64, bool),
    ) -> Result<Self, CompareError> {
        let harder = if margin { &Harder::TRIALS[..] } else { &[] };
        let world = |drawn: &Drawn| {
            let plain = arm.in_drawn(drawn, Harder::NOT, span)?;
            let trials = harder.iter().map(|harder| arm.in_drawn(drawn, *harder, span));
            Ok((drawn.model_masses, plain, trials.collect::<Result<_, CompareError>>()?))
        };
        Ok(Self { arm, worlds: drawn.iter().map(world).collect::<Result<_, CompareError>>()?, cap })
    }

    /// What a candidate measures, one per world; `None` where it did not follow. `values`: of the law's own scalars, and behind them
    /// of [`Entry::choices`] or nothing.
    pub fn measured(&self, entry: &Entry, values: &[f64]) -> Vec<Option<Tried>> {
        let tried = |(outcome, figures): (RunOutcome, Option<Figures>)| {
            let figures = figures.filter(|_| outcome.followed())?;
            Some(Tried {
                error_rms_rad: figures.error_rms_rad.max(LEAST),
                noise: figures.noise_above_50_hz?,
            })
        };
        let plain = self.worlds.iter().map(|(masses, study, _)| (*masses, study));
        self.runs(entry, values, &plain.collect::<Vec<_>>())
            .into_iter()
            .map(|run| tried(run?))
            .collect()
    }

    /// The candidate over all worlds: the geometric mean of its errors \[rad\], and as violation the sum over worlds of
    ///
    /// - 1 for each run that did not follow, and for each trial of the margin that did not,
    /// - what the noise is beyond its cap, over the cap,
    /// - what the share of samples at a torque limit is beyond 2 %, over 2 %.
    pub fn assess(&self, entry: &Entry, values: &[f64]) -> Assessed {
        let (mut logs, mut all) = (0.0, Assessed { error: 0.0, violation: 0.0 });
        let every = self.worlds.iter().flat_map(|(masses, study, trials)| {
            std::iter::once(study).chain(trials).map(|study| (*masses, study))
        });
        let mut runs = self.runs(entry, values, &every.collect::<Vec<_>>()).into_iter();
        for (_, _, trials) in &self.worlds {
            match runs.next().flatten() {
                Some((outcome, Some(figures))) => {
                    logs += figures.error_rms_rad.max(LEAST).ln();
                    all = all
                        .provided(outcome.followed())
                        .within(figures.noise_above_50_hz.unwrap_or(f64::NAN), self.cap)
                        .within(figures.saturated, LIMITED);
                }
                // Ended early, or refused: worse than any run that reached its end.
                _ => all = all.within(HALTED, 1.0),
            }
            for bears in runs.by_ref().take(trials.len()) {
                all = all.provided(bears.is_some_and(|(outcome, _)| outcome.followed()));
            }
        }
        Assessed { error: (logs / self.worlds.len().max(1) as f64).exp(), ..all }
    }

    /// The best of one search in the order of [`Assessed::cost`]: CMA-ES over the law's own scalars and [`Entry::choices`], from a start
    /// inside their ranges, `per_scalar (d + 1)` evaluations for `d` of them, and as many again each time that an end of a range was hit and gave way, `widenings` times at
    /// most. `seed` decides what the search draws.
    pub fn search(
        &self,
        entry: &Entry,
        start: &[f64],
        (per_scalar, widenings): (usize, usize),
        seed: u64,
    ) -> Widened {
        let (scalars, wide) = self.arm.free(entry);
        let runs = per_scalar * (scalars.len() + 1);
        let cost = |values: &[f64]| self.assess(entry, values).cost();
        tune_widening_from((&scalars, wide), start, (runs, widenings), seed, cost)
    }

    /// Runs in studies, each with the masses of the model that the law is handed; `None` where the law refuses these values.
    fn runs(
        &self,
        entry: &Entry,
        values: &[f64],
        studies: &[(f64, &Study)],
    ) -> Vec<Option<(RunOutcome, Option<Figures>)>> {
        let units = &self.arm.units;
        let mut all = vec![None; studies.len()];
        let (values, choices) = values.split_at(entry.scalars.len().min(values.len()));
        let Ok(chosen) = entry.chosen(choices) else { return all };
        let sensed: Vec<Cow<'_, Study>> =
            studies.iter().map(|&(_, study)| sensing(study, entry, &chosen)).collect();
        let made = |place: usize, study: &Study| -> Result<_, TrialError> {
            let period = study.control.period_ns as f64 * 1e-9;
            let tuning = Tuning::new(values, units, period)?;
            let (masses, _) = studies[place];
            let handed = self.arm.completed(entry, supply(study, units, masses)?);
            Ok((entry.build_as_chosen(&tuning, &handed, &chosen)?, handed))
        };
        let bars =
            Bars { error_bound: &self.arm.error_bound, limits: &self.arm.limits, bound: None };
        let every = sensed.iter().map(|study| &**study);
        run_many(entry, units, every, made, |place, study, trial: Result<Trial, TrialError>| {
            all[place] = trial.ok().map(|trial| judge(study, &trial.outcome, trial.broken, &bars));
        });
        all
    }
}

/// A study whose velocities are filtered as was chosen.
fn sensing<'a>(study: &'a Study, entry: &Entry, chosen: &Chosen) -> Cow<'a, Study> {
    if chosen.filter_hz.is_none() || !entry.needs.velocity {
        return Cow::Borrowed(study);
    }
    let mut study = study.clone();
    let rate = 1e9 / study.control.period_ns as f64;
    study.sensor.velocity_filter_hz = chosen.velocity_filter_hz(rate);
    Cow::Owned(study)
}

/// What a run that ended early counts as, beside 1 for one that did not follow.
const HALTED: f64 = 100.0;

/// A place in the ranges, even in logarithms: of restart 0 the default values. `stream` tells apart searches of one law that are to
/// have nothing in common but that.
pub fn random_start(scalars: &[Scalar], restart: u64, stream: u64) -> Vec<f64> {
    let mut dice = Dice::new(restart, stream);
    let place = |scalar: &Scalar| {
        let drawn = dice.log_between(scalar.low, scalar.high);
        if restart == 0 { scalar.default } else { drawn }
    };
    scalars.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::{ArmCase, Assessor, random_start};
    use crate::protocol::worlds::{Split, draw};
    use crate::sure::Sure as _;
    use phihat_rivals::rival;

    const TEXT: &str = include_str!("../../../../studies/table1.toml");

    /// Soft gains keep every constraint; ten times as stiff the loop does not bear one more sample, and a cap that is far below the noise
    /// is told as what it is broken by. A law that cannot be built is worse than all.
    #[test]
    fn what_breaks_a_constraint_is_behind_all_that_do_not() {
        let arm = ArmCase::from_text(TEXT, "table1.toml").sure();
        let worlds = draw(5, Split::Train, 2);
        let of =
            |cap: f64, margin: bool| Assessor::new(&arm, &worlds, (1.6, 1.0), (cap, margin)).sure();
        let pd = rival("pd-gravity").sure();
        let assessor = of(1.0, true);
        let soft = assessor.assess(pd, &[15.0, 1.0]);
        assert!(soft.feasible() && soft.error > 1e-3 && soft.error < 0.3, "{soft:?}");
        let stiff = assessor.assess(pd, &[200.0, 3.0]);
        assert!(!stiff.feasible() && stiff.cost() > soft.cost(), "{stiff:?}");
        let quiet = of(1e-9, false).assess(pd, &[15.0, 1.0]);
        assert!(quiet.violation > 10.0 && (quiet.error - soft.error).abs() < 1e-12, "{quiet:?}");
        let power = rival("finite-time").sure();
        let refused = assessor.assess(power, &[10.0, 40.0, 1.5, 0.1, 0.01]);
        assert!(refused.violation >= 2.0 * 99.0, "{refused:?}");
    }

    /// What is free in what a law is handed: at its default values the candidate is what it is without, to the bit; the filter reaches the
    /// sensors, the inertia and the torque the law, and a number of choices that is none of these is refused.
    #[test]
    fn choices_reach_the_law_and_its_sensors() {
        let arm = ArmCase::from_text(TEXT, "table1.toml").sure();
        let worlds = draw(5, Split::Train, 2);
        let assessor = Assessor::new(&arm, &worlds, (1.3, 1.0), (1.0, false)).sure();
        for (id, free) in [("pd-gravity", 1), ("time-delay", 2), ("adrc", 3), ("proposed-1", 3)] {
            let entry = rival(id).sure();
            let (scalars, wide) = arm.free(entry);
            assert_eq!(scalars.len(), entry.scalars.len() + free, "{id}");
            assert_eq!(wide, entry.scalars.len() + usize::from(free == 3), "{id}");
            let default: Vec<f64> = scalars.iter().map(|scalar| scalar.default).collect();
            let plain = assessor.assess(entry, &default[..entry.scalars.len()]);
            assert_eq!(assessor.assess(entry, &default), plain, "{id}");
            for place in entry.scalars.len()..scalars.len() {
                let mut other = default.clone();
                let scalar = &scalars[place];
                other[place] = if scalar.default < 1.0 { 2.0 } else { 0.7 * scalar.default };
                if scalar.name == "sensor_filter" {
                    other[place] = 40.0;
                }
                if scalar.name == "torque_fed" {
                    other[place] = 1.0 / scalar.default;
                }
                let found = assessor.assess(entry, &other);
                assert!(found != plain && found.error < 1.0, "{id} {}: {found:?}", scalar.name);
            }
            let short = assessor.assess(entry, &default[..entry.scalars.len() - 1]);
            let long: Vec<f64> = default.iter().copied().chain([1.0]).collect();
            for refused in [short, assessor.assess(entry, &long)] {
                assert!(refused.violation >= 2.0 * 99.0, "{id}: {refused:?}");
            }
        }
    }

    /// One law, two restarts: what the search finds keeps its constraints, is no worse than where it began, and a restart is repeatable.
    #[test]
    fn a_search_begins_anywhere_and_ends_no_worse() {
        let arm = ArmCase::from_text(TEXT, "table1.toml").sure();
        let assessor =
            Assessor::new(&arm, &draw(5, Split::Train, 1), (1.3, 1.0), (0.05, false)).sure();
        let pd = rival("pd-gravity").sure();
        let free = arm.free(pd).0;
        let start = |restart: u64, stream: u64| random_start(&free, restart, stream);
        assert_eq!(start(0, 1), [20.0, 1.0, 100.0]);
        assert!(start(1, 1) != start(2, 1) && start(1, 1) != start(1, 2));
        let search = || assessor.search(pd, &start(1, 1), (5, 0), 1);
        let found = search();
        let tuned = &found.tuned;
        assert_eq!(tuned.history.len(), 20);
        assert!(tuned.cost <= tuned.history[0] && tuned.cost < 1.0, "{found:?}");
        assert_eq!(found, search());
        assert!(assessor.measured(pd, &tuned.values)[0].is_some());
    }
}
