//! Start distance and torque limit varied together: where the arm settles, how late, and whether it keeps its bounds.

use phihat::Form;
use phihat_study::{Curve, ReferenceRequest, Study};

use super::claims::keeps_bounds;
use super::run::Run;
use super::studies::{GainSetting, Studies, StudyKind};
use super::variations::{limited, unlimited};
use crate::part::{Extent, PartError};

/// Start distances that are tried beside that of the studies \[m\].
const DISTANCES: [f64; 6] = [0.01, 0.02, 0.035, 0.05, 0.07, 0.1];
/// Torque limits that are tried \[N·m\].
const LIMITS: [f64; 11] = [10.0, 20.0, 35.0, 50.0, 70.0, 100.0, 150.0, 200.0, 400.0, 800.0, 1600.0];
/// Places of those that a quick map has, and that the observer form is tried at.
const FEW: ([usize; 1], [usize; 2]) = ([3], [3, 7]);
/// A transient this many times as long as without the limit is a long one.
pub(crate) const LONG: f64 = 1.5;
/// Nearest start that is tried for the edge \[m\] (a path that begins nearer leaves the arm's reach), and number
/// of bisection steps.
pub(crate) const NEAREST_M: f64 = 5e-3;
const STEPS: u32 = 7;

/// Outcome of a run under a limit, compared with the run without one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum StartOutcome {
    /// It does not settle in two turns.
    Lost,
    /// It settles, and does not keep the bounds of (48), (49) that it keeps without the limit.
    Spoiled,
    /// It settles about as soon as without the limit.
    Soon,
    /// It settles, and takes [`LONG`] times as long or longer.
    Late,
}

/// Meaning of the classes of the map, in the order of [`StartOutcome`].
pub(crate) const CLASSES: [&str; 4] = [
    "does not settle",
    "settles, bounds not kept",
    "settles about as soon as without a limit",
    "settles late, for the limit",
];

/// A run with its times.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    pub(crate) limit: f64,
    pub(crate) outcome: StartOutcome,
    /// When it has settled \[s\].
    pub(crate) at: Option<f64>,
}

/// A start distance \[m\], when the run without a limit has settled \[s\], and the runs with one.
#[derive(Debug)]
pub(crate) struct StartMapRow {
    pub(crate) distance: f64,
    pub(crate) free: Option<f64>,
    pub(crate) cells: Vec<Cell>,
}

/// The map of one setting in one form.
#[derive(Debug)]
pub(crate) struct Mapped {
    pub(crate) setting: GainSetting,
    pub(crate) form: Form,
    pub(crate) rows: Vec<StartMapRow>,
    /// Farthest start from which the printed form settles and satisfies its bounds under the limit of the
    /// studies \[m\].
    pub(crate) edge: Option<f64>,
}

/// All maps.
#[derive(Debug)]
pub(crate) struct StartMap {
    pub(crate) maps: Vec<Mapped>,
    /// The limit of the studies \[N·m\], and how far from the path they start \[m\].
    pub(crate) assumed: (f64, f64),
    /// True if all places were tried.
    pub(crate) whole: bool,
}

impl StartMap {
    /// The printed form of every setting over the whole map, the observer form at a few places.
    pub(crate) fn of(
        studies: &Studies,
        extent: Extent,
        progress: &dyn Fn(f64),
    ) -> Result<Self, PartError> {
        let own = studies.study(StudyKind::Experiment, GainSetting::First, Form::Observer)?;
        let [start, begin] = ends(&own)?;
        let far = (start[0] - begin[0]).hypot(start[1] - begin[1]);
        let limit = own.control.torque_max.as_ref().and_then(|all| all.first());
        // Studies that were changed to have no limit are mapped all the same.
        let assumed = (limit.copied().unwrap_or(LIMITS[FEW.1[0]]), far);
        let few = (FEW.0.map(|k| DISTANCES[k]).to_vec(), FEW.1.map(|k| LIMITS[k]).to_vec());
        let all = if extent.quick { few.clone() } else { (DISTANCES.to_vec(), LIMITS.to_vec()) };
        let mut maps = Vec::new();
        for (form, (distances, limits)) in [(Form::Literal, all), (Form::Observer, few)] {
            for setting in GainSetting::ALL {
                let study = studies.study(StudyKind::Experiment, setting, form)?;
                let own_start = (far > NEAREST_M).then_some(&far);
                let near = |distance: f64| moved(study.clone(), [start, begin], distance);
                let at = |distance: &f64| row(&near(*distance), setting, *distance, &limits);
                let rows = distances.iter().chain(own_start).map(at).collect::<Result<_, _>>()?;
                let edge = match form {
                    Form::Literal => edge(&near, setting, assumed)?,
                    Form::Observer | Form::Positions => None,
                };
                maps.push(Mapped { setting, form, rows, edge });
                progress(maps.len() as f64 / (2.0 * GainSetting::ALL.len() as f64));
            }
        }
        Ok(Self { maps, assumed, whole: !extent.quick })
    }

    /// The map of a setting in the printed form.
    pub(crate) fn printed(&self, setting: GainSetting) -> Option<&Mapped> {
        self.maps.iter().find(|map| map.setting == setting && map.form == Form::Literal)
    }

    /// Returns true if, for each of some settings in the printed form, a run from some start under the limit of the
    /// studies came to one of these outcomes.
    pub(crate) fn somewhere(&self, settings: &[GainSetting], outcomes: &[StartOutcome]) -> bool {
        let of = |map: &Mapped| {
            let cells = map.rows.iter().flat_map(|row| &row.cells);
            let mut here = cells.filter(|cell| cell.limit.total_cmp(&self.assumed.0).is_eq());
            here.any(|cell| outcomes.contains(&cell.outcome))
        };
        settings.iter().all(|setting| self.printed(*setting).is_some_and(of))
    }

    /// Number of places of a form with one of these outcomes, and number of all its places.
    pub(crate) fn count(&self, form: Form, outcomes: &[StartOutcome]) -> (usize, usize) {
        let maps = self.maps.iter().filter(|map| map.form == form);
        let cells = || maps.clone().flat_map(|map| &map.rows).flat_map(|row| &row.cells);
        (cells().filter(|cell| outcomes.contains(&cell.outcome)).count(), cells().count())
    }
}

impl Mapped {
    /// The smallest limit from which on every run from a distance settles and keeps its bounds \[N·m\].
    pub(crate) fn enough(&self, distance: f64) -> Option<f64> {
        let row = self.rows.iter().find(|row| row.distance.total_cmp(&distance).is_eq())?;
        let last = row.cells.iter().rposition(|cell| cell.outcome < StartOutcome::Soon);
        row.cells.get(last.map_or(0, |k| k + 1)).map(|cell| cell.limit)
    }
}

/// Tip and desired tip at the start.
fn ends(study: &Study) -> Result<[[f64; 2]; 2], PartError> {
    let mut study = study.clone();
    study.duration = 10.0 * study.control.period_ns as f64 * 1e-9;
    let tips = Run::of(study)?.tips(1)?;
    tips.first().copied().ok_or(PartError::Missing("the run has no sample"))
}

/// The study with its path moved as a whole, so that it begins so far from where the tip starts, on the same side.
fn moved(mut study: Study, [start, begin]: [[f64; 2]; 2], distance: f64) -> Study {
    let away = [begin[0] - start[0], begin[1] - start[1]];
    let length = away[0].hypot(away[1]);
    // Studies that start on their path are moved towards the base.
    let towards = if length > 1e-9 { away.map(|part| part / length) } else { [-1.0, 0.0] };
    if let ReferenceRequest::Cartesian { curve: Curve::Spline { points }, .. } =
        &mut study.reference
    {
        for point in points {
            point[0] += distance * towards[0] - away[0];
            point[2] += distance * towards[1] - away[1];
        }
    }
    study
}

/// Outcome of a run with a limit, compared with the run without one.
fn outcome(run: &Run, free: &Run, setting: GainSetting) -> StartOutcome {
    let spoiled = keeps_bounds(free, setting) && !keeps_bounds(run, setting);
    match (run.settled_at(), free.settled_at()) {
        (None, _) => StartOutcome::Lost,
        (Some(_), _) if spoiled => StartOutcome::Spoiled,
        (Some(at), Some(free)) if at >= LONG * free => StartOutcome::Late,
        (Some(_), _) => StartOutcome::Soon,
    }
}

fn row(
    study: &Study,
    setting: GainSetting,
    distance: f64,
    limits: &[f64],
) -> Result<StartMapRow, PartError> {
    let free = Run::of(unlimited(study.clone()))?;
    let cell = |limit: &f64| {
        let run = Run::of(limited(study.clone(), *limit))?;
        let outcome = outcome(&run, &free, setting);
        Ok(Cell { limit: *limit, outcome, at: run.settled_at() })
    };
    let cells = limits.iter().map(cell).collect::<Result<_, PartError>>()?;
    Ok(StartMapRow { distance, free: free.settled_at(), cells })
}

/// m = 1 as printed on the study of the experiments, started so far from the path: with the limit and without.
pub(crate) fn nearer(studies: &Studies, distance: f64) -> Result<[Run; 2], PartError> {
    let study = studies.study(StudyKind::Experiment, GainSetting::First, Form::Literal)?;
    let ends = ends(&study)?;
    let study = moved(study, ends, distance);
    Ok([Run::of(study.clone())?, Run::of(unlimited(study))?])
}

/// The farthest start, by bisection, from which the arm settles and keeps its bounds under a limit; `None`: from none.
fn edge(
    near: &dyn Fn(f64) -> Study,
    setting: GainSetting,
    (limit, far): (f64, f64),
) -> Result<Option<f64>, PartError> {
    let holds = |distance: f64| -> Result<bool, PartError> {
        let run = Run::of(limited(near(distance), limit))?;
        Ok(run.settled_at().is_some() && keeps_bounds(&run, setting))
    };
    if holds(far)? {
        return Ok(Some(far));
    }
    if !holds(NEAREST_M)? {
        return Ok(None);
    }
    let (mut low, mut high) = (NEAREST_M, far);
    for _ in 0..STEPS {
        let middle = (low * high).sqrt();
        if holds(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(Some(low))
}
