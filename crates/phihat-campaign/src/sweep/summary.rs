//! The answer of a sweep, as data.

use serde::Serialize;

use super::plan::SweepPlan;
use super::row::{FIGURES, SweepColumns, SweepRow};
use crate::chunks::{ChunksError, RowFile};
use crate::statistics::{CONFIDENCE, quantile_places, share_interval};

/// Version of `sweep.json`.
pub const FORMAT: u32 = 1;

/// Shares of the reported quantiles.
const SHARES: [f64; 8] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 0.999];

/// Number of worst runs that are reported.
pub(crate) const WORST: usize = 10;

/// Runs that are drawn at most.
const DRAWN: u64 = 1500;

/// Points of a curve.
const POINTS: u64 = 200;

/// Answer of a sweep.
#[derive(Debug, Clone, Serialize)]
pub struct SweepSummary {
    /// [`FORMAT`].
    pub format: u32,
    /// Version of phihat.
    pub phihat_version: String,
    /// The study's name.
    pub study: String,
    /// SHA-256 of the study's text.
    pub study_sha256: String,
    /// Numbers that vary, as they were written, with their units.
    pub vary: Vec<VaryRecord>,
    /// The sweep's seed.
    pub seed: u64,
    /// All runs.
    pub runs: u64,
    /// Numbers of runs by their end.
    pub totals: SweepTotals,
    /// Probability that an interval encloses what it is about, at least.
    pub confidence: f64,
    /// Figures, with their quantiles over all runs that began; `null` stands for a run that did not reach its
    /// end, which is worse than any number.
    pub figures: Vec<FigureRecord>,
    /// The worst runs, the worst one first.
    pub worst: Vec<WorstRun>,
    /// The columns of `runs.npy`: name, and type as NumPy has it.
    pub columns: Vec<(String, String)>,
    /// SHA-256 of `runs.npy`.
    pub runs_sha256: String,
}

/// Something that varied.
#[derive(Debug, Clone, Serialize)]
pub struct VaryRecord {
    /// Its column.
    pub name: String,
    /// As it was written.
    pub how: String,
    /// Its unit; empty for a factor, or where there is none.
    pub unit: String,
}

/// Numbers of runs by their end.
#[derive(Debug, Clone, Serialize)]
pub struct SweepTotals {
    /// Runs that came to their end.
    pub whole: u64,
    /// That diverged.
    pub diverged: u64,
    /// That the robot's interface stopped.
    pub stopped: u64,
    /// Whose study could not be run: these are in no other figure.
    pub refused: u64,
    /// That panicked, a fault of this program.
    pub panicked: u64,
    /// Runs that kept every bound that the study states.
    pub within_spec: u64,
    /// The same as a share of the runs that began, `null` where none did, with its interval.
    pub within_spec_share: Option<f64>,
    /// Lower and upper end.
    pub within_spec_interval: [f64; 2],
}

/// A figure over all runs.
#[derive(Debug, Clone, Serialize)]
pub struct FigureRecord {
    /// Its column.
    pub name: String,
    /// Description.
    pub what: String,
    /// Its unit.
    pub unit: String,
    /// Runs that have it.
    pub runs: u64,
    /// The least.
    pub least: f64,
    /// The largest; `null` where a run did not come to its end.
    pub largest: f64,
    /// Quantiles.
    pub quantiles: Vec<Quantile>,
    /// Evenly spaced quantiles, for a curve.
    #[serde(skip)]
    pub(crate) curve: Vec<(f64, f64)>,
}

/// A quantile with its interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantile {
    /// Share of runs at or below it.
    pub share: f64,
    /// Its estimate.
    pub value: f64,
    /// Lower end of its interval; `null`: so few runs do not bound it there.
    pub low: Option<f64>,
    /// Upper end; `null` likewise, or beyond any number.
    pub high: Option<f64>,
}

/// One of the worst runs.
#[derive(Debug, Clone, Serialize)]
pub struct WorstRun {
    /// Its place.
    pub run: u64,
    /// The seed of its study.
    pub seed: u64,
    /// End of the run.
    pub ended: String,
    /// Values of the numbers that varied, in the order of `vary`.
    pub values: Vec<f64>,
    /// Its error over the bound, else its largest steady error \[rad\]; `null` where it did not come to its end.
    pub error: f64,
    /// Repeats it, from the folder of the results.
    pub command: String,
}

/// The rows of a sweep looked through: its answer, and the runs that are drawn.
pub(crate) struct SweepResult {
    pub(crate) summary: SweepSummary,
    pub(crate) drawn: Vec<SweepRow>,
    /// The studies of the worst runs, by their file's name.
    pub(crate) studies: Vec<(String, String)>,
}

/// Looks through all rows, column by column: memory is one column.
pub(crate) fn look(plan: &SweepPlan, file: &mut RowFile) -> Result<SweepResult, ChunksError> {
    let columns = plan.columns();
    let mut seen = SweepCounts::default();
    let by = by_spec(plan);
    let stride = plan.runs.div_ceil(DRAWN).max(1);
    file.each(plan.runs, |bytes| {
        if let Some(row) = columns.row(bytes) {
            seen.take(row, by, stride);
        }
    })?;
    let figures = figures(plan, &columns, file)?;
    let (worst, studies) = seen.worst(plan, by);
    let drawn = seen.drawn;
    let [whole, diverged, stopped, refused, panicked] = seen.ends;
    let began = whole + diverged + stopped;
    let within = seen.within;
    let interval = share_interval(within, began);
    let vary = plan.vary.iter().map(|vary| VaryRecord {
        name: vary.name(),
        how: vary.text().to_owned(),
        unit: vary.unit().to_owned(),
    });
    let summary = SweepSummary {
        format: FORMAT,
        phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
        study: plan.study.name.clone(),
        study_sha256: plan.study.sha256.clone(),
        vary: vary.collect(),
        seed: plan.seed,
        runs: plan.runs,
        totals: SweepTotals {
            whole,
            diverged,
            stopped,
            refused,
            panicked,
            within_spec: within,
            within_spec_share: (began > 0).then(|| within as f64 / began as f64),
            within_spec_interval: [interval.0, interval.1],
        },
        confidence: CONFIDENCE,
        figures,
        worst,
        columns: columns.all().into_iter().map(|(name, kind)| (name, kind.to_owned())).collect(),
        runs_sha256: file.sha256()?,
    };
    Ok(SweepResult { summary, drawn, studies })
}

/// The figure by which runs are better or worse: error over the bound where the study states one.
fn by_spec(plan: &SweepPlan) -> usize {
    usize::from(plan.study.spec.error_bound.is_some())
}

#[derive(Default)]
struct SweepCounts {
    ends: [u64; 5],
    within: u64,
    drawn: Vec<SweepRow>,
    /// The worst so far, the worst one first.
    worst: Vec<SweepRow>,
}

impl SweepCounts {
    fn take(&mut self, row: SweepRow, by: usize, stride: u64) {
        self.ends[row.end as usize] += 1;
        self.within += u64::from(row.within_spec);
        if row.end.ran() {
            let worse = |other: &SweepRow| other.figures[by].total_cmp(&row.figures[by]).is_ge();
            let place = self.worst.partition_point(worse);
            if place < WORST {
                self.worst.insert(place, row.clone());
                self.worst.truncate(WORST);
            }
        }
        if row.run.is_multiple_of(stride) {
            self.drawn.push(row);
        }
    }

    fn worst(&self, plan: &SweepPlan, by: usize) -> (Vec<WorstRun>, Vec<(String, String)>) {
        let (mut told, mut studies) = (Vec::new(), Vec::new());
        for row in &self.worst {
            let Ok((text, uncertified)) = plan.repeated(row.run) else { continue };
            let name = format!("run-{}.toml", row.run);
            let gains = if plan.own_gains { "" } else { " --gains gains.json" };
            let mark = if uncertified { " --uncertified" } else { "" };
            told.push(WorstRun {
                run: row.run,
                seed: row.seed,
                ended: row.end.word().to_owned(),
                values: row.values.clone(),
                error: row.figures[by],
                command: format!("phihat run worst/{name}{gains}{mark}"),
            });
            studies.push((name, text));
        }
        (told, studies)
    }
}

fn figures(
    plan: &SweepPlan,
    columns: &SweepColumns,
    file: &mut RowFile,
) -> Result<Vec<FigureRecord>, ChunksError> {
    let mut all = Vec::new();
    for (i, kind) in FIGURES.iter().enumerate() {
        let mut values: Vec<f64> = Vec::new();
        file.each(plan.runs, |bytes| {
            values.extend(columns.row(bytes).map(|row| row.figures[i]).filter(|x| !x.is_nan()));
        })?;
        if values.is_empty() {
            continue;
        }
        values.sort_unstable_by(f64::total_cmp);
        let words = (kind.name.to_owned(), kind.what.to_owned(), kind.unit.to_owned());
        all.push(figure(words, &values));
    }
    Ok(all)
}

/// Of sorted values, at least one.
fn figure((name, what, unit): (String, String, String), sorted: &[f64]) -> FigureRecord {
    let n = sorted.len() as u64;
    let at = |place: u64| {
        let place = usize::try_from(place.saturating_sub(1)).unwrap_or(usize::MAX);
        sorted.get(place).copied().unwrap_or(f64::NAN)
    };
    let quantile = |share: &f64| {
        let places = quantile_places(n, *share)?;
        let (low, high) = (places.low.map(at), places.high.map(at));
        Some(Quantile { share: *share, value: at(places.at), low, high })
    };
    let steps = POINTS.min(n);
    let step = |k: u64| {
        let place = (n * k).div_ceil(steps).max(1);
        (at(place), place as f64 / n as f64)
    };
    FigureRecord {
        name,
        what,
        unit,
        runs: n,
        least: at(1),
        largest: at(n),
        quantiles: SHARES.iter().filter_map(quantile).collect(),
        curve: (0..=steps).map(step).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::row::SweepEnd;
    use super::figure;

    #[test]
    fn quantiles_are_values_of_the_sample() {
        let values: Vec<f64> = (1..=1000).map(f64::from).collect();
        let told = figure((String::new(), String::new(), String::new()), &values);
        let of =
            |share: f64| told.quantiles.iter().find(|q| (q.share - share).abs() < 1e-12).cloned();
        let middle = of(0.5).map(|q| (q.value, q.low, q.high));
        // By the normal approximation 500 ± 1.96·sqrt(250) = 469 … 531, corrected for steps.
        assert_eq!(middle, Some((500.0, Some(469.0), Some(532.0))));
        assert_eq!(of(0.999).map(|q| (q.value, q.high)), Some((999.0, None)));
        assert!((told.curve[0].0 - 1.0).abs() < 1e-12 && told.curve.len() == 201);
        assert_eq!(SweepEnd::ALL.map(|end| end as usize), [0, 1, 2, 3, 4]);
    }
}
