//! A candidate, tried in drawn worlds: its error, and the constraints that it violates.

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
use crate::trial::{ComparisonTrial, TrialError, run_many};
use crate::tune::{AtEnd, ends, tune_widening_from};

/// Evaluations of one search, for each of a law's free scalars and one more.
pub const PER_SCALAR: usize = 200;

/// Divisor of a search's evaluations under every cap but the loosest: it begins at the result of the looser
/// ones.
pub const FOLLOWING: usize = 4;

/// Errors below this \[rad\] are alike: a microradian is below the resolution of an encoder of 22 bits.
const LEAST: f64 = 1e-6;

/// Figures of a run that followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AssessedRun {
    /// Root mean square of the error of the worst joint \[rad\]; a microradian at least.
    pub error_rms_rad: f64,
    /// Root mean square of the torque above 50 Hz over its limit, of the worst joint.
    pub noise: f64,
}

/// Outcome of a run, and its figures where it has some.
type Ran = (RunOutcome, Option<Figures>);

impl AssessedRun {
    /// Of a run; `None` where it did not follow.
    fn of((outcome, figures): &Ran) -> Option<Self> {
        let figures = figures.as_ref().filter(|_| outcome.followed())?;
        let error_rms_rad = figures.error_rms_rad.max(LEAST);
        Some(Self { error_rms_rad, noise: figures.noise_above_50_hz? })
    }
}

/// Worlds in which candidates are tried.
#[derive(Debug, Clone)]
pub struct Assessor<'a> {
    arm: &'a ArmCase,
    /// Each world: masses of the model that laws get there, its study, and the studies of the trials of a
    /// margin.
    worlds: Vec<(f64, Study, Vec<Study>)>,
    /// The largest noise of a run whose margin is tried.
    loosest: f64,
}

/// A candidate and its result over all worlds, under no cap yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Assayed {
    /// Values of the law's scalars and of the free choices in its inputs.
    pub values: Vec<f64>,
    /// The geometric mean of its errors, and what is broken of all constraints but the cap on noise.
    uncapped: Assessed,
    /// Noise in each world whose end it reached.
    noise: Vec<f64>,
}

impl Assayed {
    /// Under a cap on noise above 50 Hz over the torque limit: the geometric mean of its errors \[rad\], and
    /// as violation the sum over worlds of
    ///
    /// - 1 for each run that did not follow, and for each trial of the margin that did not, or that was not
    ///   run because the candidate failed in the world itself,
    /// - what the noise is beyond its cap, over the cap,
    /// - what the share of samples at a torque limit is beyond 2 %, over 2 %.
    pub fn at(&self, cap: f64) -> Assessed {
        self.noise.iter().fold(self.uncapped, |all, noise| all.within(*noise, cap))
    }
}

/// The best of a search under one of its caps.
#[derive(Debug, Clone, PartialEq)]
pub struct BestOfCap {
    /// The candidate.
    pub values: Vec<f64>,
    /// Under this cap.
    pub assessed: Assessed,
    /// Candidates that were tried, under all caps.
    pub evaluations: usize,
    /// The least cost under this cap after so many of them, where it fell.
    pub history: Vec<(usize, f64)>,
    /// Number of times that ranges were widened in the search under this cap.
    pub widened: usize,
    /// Ends of ranges that the values are at all the same.
    pub at_end: Vec<AtEnd>,
}

impl<'a> Assessor<'a> {
    /// For drawn worlds of a length \[s\] whose score begins at `span.1`; `margin`: with its trials, for runs
    /// whose noise above 50 Hz over the torque limit is no more than this.
    ///
    /// # Errors
    ///
    /// [`CompareError`]: the arm's study does not bear a world.
    pub fn new(
        arm: &'a ArmCase,
        drawn: &[Drawn],
        span: (f64, f64),
        margin: Option<f64>,
    ) -> Result<Self, CompareError> {
        let harder = if margin.is_some() { &Harder::TRIALS[..] } else { &[] };
        let world = |drawn: &Drawn| {
            let plain = arm.in_drawn(drawn, Harder::NOT, span)?;
            let trials = harder.iter().map(|harder| arm.in_drawn(drawn, *harder, span));
            Ok((drawn.model_masses, plain, trials.collect::<Result<_, CompareError>>()?))
        };
        let worlds = drawn.iter().map(world).collect::<Result<_, CompareError>>()?;
        Ok(Self { arm, worlds, loosest: margin.unwrap_or(f64::INFINITY) })
    }

    /// Figures of a candidate, one per world; `None` where it did not follow. `values`: those of the
    /// law's own scalars, followed by none or those of [`Entry::choices`].
    pub fn measured(&self, entry: &Entry, values: &[f64]) -> Vec<Option<AssessedRun>> {
        self.plain(entry, values).iter().map(|run| AssessedRun::of(run.as_ref()?)).collect()
    }

    /// Assesses the candidate over all worlds. The trials of a margin are run in the worlds where the
    /// candidate followed with noise within the loosest cap; in the others they count as failed.
    pub fn assay(&self, entry: &Entry, values: &[f64]) -> Assayed {
        let plain = self.plain(entry, values);
        let held =
            |run: &Ran| AssessedRun::of(run).is_some_and(|tried| tried.noise <= self.loosest);
        let held: Vec<bool> = plain.iter().map(|run| run.as_ref().is_some_and(held)).collect();
        let tried = self.worlds.iter().zip(&held).filter(|(_, held)| **held);
        let trials = tried.flat_map(|((masses, _, trials), _)| trials.iter().map(|t| (*masses, t)));
        let mut trials = self.runs(entry, values, &trials.collect::<Vec<_>>()).into_iter();
        let (mut logs, mut noise) = (0.0, Vec::new());
        let mut all = Assessed { error: 0.0, violation: 0.0 };
        for ((run, held), (_, _, harder)) in plain.into_iter().zip(held).zip(&self.worlds) {
            match run {
                Some((outcome, Some(figures))) => {
                    logs += figures.error_rms_rad.max(LEAST).ln();
                    all = all.provided(outcome.followed()).within(figures.saturated, LIMITED);
                    noise.push(figures.noise_above_50_hz.unwrap_or(f64::NAN));
                }
                // Ended early, or refused: worse than any run that reached its end.
                _ => all = all.within(HALTED, 1.0),
            }
            for _ in harder {
                let borne = held.then(|| trials.next().flatten()).flatten();
                all = all.provided(borne.is_some_and(|(outcome, _)| outcome.followed()));
            }
        }
        let error = (logs / self.worlds.len().max(1) as f64).exp();
        Assayed { values: values.to_vec(), uncapped: Assessed { error, ..all }, noise }
    }

    /// One search under several caps, from the loosest to the tightest: CMA-ES over the law's own scalars and
    /// [`Entry::choices`] in the order of [`Assessed::cost`], under each cap from the best candidate so far.
    /// The loosest has `per_scalar (d + 1)` evaluations for `d` free scalars, every other one
    /// [a quarter](FOLLOWING) as many; and as many again each time that a range is widened at an end that was
    /// hit, `widenings` times at most. `starts`: candidates to begin from, inside the ranges. `seed`
    /// determines all draws of the search.
    ///
    /// Returns, in the order of the caps, the best of everything that was tried: none of a looser cap is
    /// worse than one of a tighter.
    pub fn search(
        &self,
        entry: &Entry,
        starts: &[Vec<f64>],
        caps: &[f64],
        (per_scalar, widenings): (usize, usize),
        seed: u64,
    ) -> Vec<BestOfCap> {
        let (mut scalars, wide) = self.arm.free(entry);
        let mut tried: Vec<Assayed> =
            starts.iter().map(|values| self.assay(entry, values)).collect();
        let mut order: Vec<usize> = (0..caps.len()).collect();
        order.sort_by(|a, b| caps[*b].total_cmp(&caps[*a]));
        let mut widened = vec![0; caps.len()];
        for (nth, place) in order.into_iter().enumerate() {
            let cap = caps[place];
            let (share, seed) = (if nth == 0 { 1 } else { FOLLOWING }, seed + nth as u64);
            let runs = per_scalar.div_ceil(share) * (scalars.len() + 1);
            let Some(start) = best(&tried, cap).map(|best| best.values.clone()) else { break };
            let cost = |values: &[f64]| {
                if let Some(known) = tried.iter().find(|one| one.values == values) {
                    return known.at(cap).cost();
                }
                let one = self.assay(entry, values);
                let cost = one.at(cap).cost();
                tried.push(one);
                cost
            };
            let found = tune_widening_from((&scalars, wide), &start, (runs, widenings), seed, cost);
            for (scalar, [low, high]) in scalars.iter_mut().zip(found.ranges) {
                (scalar.low, scalar.high) = (low, high);
            }
            widened[place] = found.rounds - 1;
        }
        let answer = |(cap, widened): (&f64, usize)| {
            let best = best(&tried, *cap)?;
            Some(BestOfCap {
                values: best.values.clone(),
                assessed: best.at(*cap),
                evaluations: tried.len(),
                history: falls(tried.iter().map(|one| one.at(*cap).cost())),
                widened,
                at_end: ends(&scalars[..wide], &best.values),
            })
        };
        caps.iter().zip(widened).filter_map(answer).collect()
    }

    /// Runs in the worlds as they are.
    fn plain(&self, entry: &Entry, values: &[f64]) -> Vec<Option<Ran>> {
        let plain = self.worlds.iter().map(|(masses, study, _)| (*masses, study));
        self.runs(entry, values, &plain.collect::<Vec<_>>())
    }

    /// Runs in studies, each with the masses of the model that the law is handed; `None` where the law
    /// refuses these values.
    fn runs(&self, entry: &Entry, values: &[f64], studies: &[(f64, &Study)]) -> Vec<Option<Ran>> {
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
        run_many(
            entry,
            units,
            every,
            made,
            |place, study, trial: Result<ComparisonTrial, TrialError>| {
                all[place] =
                    trial.ok().map(|trial| judge(study, &trial.outcome, trial.broken, &bars));
            },
        );
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

/// The first of those with the least cost under a cap.
fn best(tried: &[Assayed], cap: f64) -> Option<&Assayed> {
    tried.iter().min_by(|a, b| a.at(cap).cost().total_cmp(&b.at(cap).cost()))
}

/// Evaluations at which the least cost fell: their number, and the new cost.
fn falls(history: impl Iterator<Item = f64>) -> Vec<(usize, f64)> {
    let mut least = f64::INFINITY;
    let mut fell = |(count, cost): (usize, f64)| {
        let falls = cost < least;
        least = least.min(cost);
        falls.then_some((count, cost))
    };
    (1..).zip(history).filter_map(&mut fell).collect()
}

/// Value of a run that ended early, against a limit of 1; a run that did not follow adds 1.
const HALTED: f64 = 100.0;

/// A place in the ranges, uniform in logarithms; for restart 0 the default values. `stream` separates
/// searches of one law that are to be independent.
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
    use super::{ArmCase, Assessor, falls, random_start};
    use crate::protocol::worlds::{Split, draw};
    use crate::sure::Sure as _;
    use phihat_rivals::rival;

    const TEXT: &str = include_str!("../../../../studies/table1.toml");

    /// Soft gains satisfy every constraint; with gains ten times as stiff the loop does not tolerate one more
    /// sample of delay, and noise far above a cap counts by its excess. A law that cannot be built is worse
    /// than all.
    #[test]
    fn what_breaks_a_constraint_is_behind_all_that_do_not() {
        let arm = ArmCase::from_text(TEXT, "table1.toml").sure();
        let worlds = draw(5, Split::Train, 2);
        let of = |margin: Option<f64>| Assessor::new(&arm, &worlds, (1.6, 1.0), margin).sure();
        let pd = rival("pd-gravity").sure();
        let assessor = of(Some(1.0));
        let assess = |entry, values: &[f64]| assessor.assay(entry, values).at(1.0);
        let soft = assess(pd, &[15.0, 1.0]);
        assert!(soft.feasible() && soft.error > 1e-3 && soft.error < 0.3, "{soft:?}");
        let stiff = assess(pd, &[200.0, 3.0]);
        assert!(!stiff.feasible() && stiff.cost() > soft.cost(), "{stiff:?}");
        let quiet = of(None).assay(pd, &[15.0, 1.0]).at(1e-9);
        assert!(quiet.violation > 10.0 && (quiet.error - soft.error).abs() < 1e-12, "{quiet:?}");
        // Louder than the loosest cap: its margin is not tried, and counts as not borne.
        let loud = of(Some(1e-9)).assay(pd, &[15.0, 1.0]).at(1.0);
        assert!(loud.violation >= 4.0 && (loud.error - soft.error).abs() < 1e-12, "{loud:?}");
        let power = rival("finite-time").sure();
        let refused = assess(power, &[10.0, 40.0, 1.5, 0.1, 0.01]);
        assert!(refused.violation >= 2.0 * 99.0, "{refused:?}");
    }

    /// Free choices in a law's inputs: at their default values the candidate is the one without them, to the
    /// bit; the filter reaches the sensors, the inertia and the torque reach the law, and a wrong number of
    /// choices is refused.
    #[test]
    fn choices_reach_the_law_and_its_sensors() {
        let arm = ArmCase::from_text(TEXT, "table1.toml").sure();
        let worlds = draw(5, Split::Train, 2);
        let assessor = Assessor::new(&arm, &worlds, (1.3, 1.0), None).sure();
        let assess = |entry, values: &[f64]| assessor.assay(entry, values).at(1.0);
        for (id, free) in [("pd-gravity", 1), ("time-delay", 2), ("adrc", 3), ("proposed-1", 3)] {
            let entry = rival(id).sure();
            let (scalars, wide) = arm.free(entry);
            assert_eq!(scalars.len(), entry.scalars.len() + free, "{id}");
            assert_eq!(wide, entry.scalars.len() + usize::from(free == 3), "{id}");
            let default: Vec<f64> = scalars.iter().map(|scalar| scalar.default).collect();
            let plain = assess(entry, &default[..entry.scalars.len()]);
            assert_eq!(assess(entry, &default), plain, "{id}");
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
                let found = assess(entry, &other);
                assert!(found != plain && found.error < 1.0, "{id} {}: {found:?}", scalar.name);
            }
            let short = assess(entry, &default[..entry.scalars.len() - 1]);
            let long: Vec<f64> = default.iter().copied().chain([1.0]).collect();
            for refused in [short, assess(entry, &long)] {
                assert!(refused.violation >= 2.0 * 99.0, "{id}: {refused:?}");
            }
        }
    }

    /// One law, two caps: the result of the search satisfies its constraints, is no worse than its start nor,
    /// under the looser cap, than under the tighter; the loosest comes first for any order of the caps, and a
    /// restart is repeatable.
    #[test]
    fn a_search_begins_anywhere_and_ends_no_worse() {
        let arm = ArmCase::from_text(TEXT, "table1.toml").sure();
        let assessor = Assessor::new(&arm, &draw(5, Split::Train, 1), (1.3, 1.0), None).sure();
        let pd = rival("pd-gravity").sure();
        let free = arm.free(pd).0;
        let start = |restart: u64, stream: u64| random_start(&free, restart, stream);
        assert_eq!(start(0, 1), [20.0, 1.0, 100.0]);
        assert!(start(1, 1) != start(2, 1) && start(1, 1) != start(1, 2));
        let search = |caps: &[f64]| assessor.search(pd, &[start(1, 1)], caps, (5, 0), 1);
        let found = search(&[0.01, 0.05]);
        let [tight, loose] = &found[..] else { panic!("{found:?}") };
        for best in [tight, loose] {
            let falls: Vec<f64> = best.history.iter().map(|fell| fell.1).collect();
            assert!(falls.is_sorted_by(|a, b| a > b) && best.history[0].0 == 1, "{best:?}");
            assert!((falls[falls.len() - 1] - best.assessed.cost()).abs() < 1e-15);
            assert!(best.history.iter().all(|fell| fell.0 <= 20 + 8));
            assert!(assessor.measured(pd, &best.values)[0].is_some());
        }
        assert!(loose.assessed.cost() <= tight.assessed.cost() && loose.assessed.cost() < 1.0);
        assert!(found.iter().eq(search(&[0.05, 0.01]).iter().rev()));
    }

    /// Gains that are designed for the hardest loop that can be drawn satisfy every constraint in drawn worlds;
    /// those for the study's own loop, which is easier, do not.
    #[test]
    fn a_design_that_is_told_of_the_worlds_bears_them() {
        let arm = || ArmCase::from_text(TEXT, "table1.toml").sure();
        let worlds = draw(1, Split::Train, 4);
        let designed = rival("proposed-positions-designed").sure();
        let feasible = |arm: &ArmCase| {
            let assessor = Assessor::new(arm, &worlds, (1.6, 1.0), Some(0.005)).sure();
            assessor.assay(designed, &[]).at(0.005).feasible()
        };
        assert!(feasible(&arm().told_of_drawn()) && !feasible(&arm()));
    }

    #[test]
    fn only_what_falls_is_kept() {
        let falls = falls([3.0, 4.0, 2.0, 2.0, 2.5, 1.0].into_iter());
        assert_eq!(falls, [(1, 3.0), (3, 2.0), (6, 1.0)]);
    }
}
