//! The four columns of a row, measured.

use phihat_rivals::Entry;

use crate::arm_case::ArmCase;
use crate::arm_in_world::ComparisonTask;
use crate::mark::Mark;
use crate::promise;
use crate::row::{GainsKind, LawCell, MarkColumns, MeasuredTicks, TuningRecord};
use crate::world::{SATURATION, TRAINING};

/// Share of draws from which gains are easy to find, and from which they are partly so.
pub const EASY_SHARES: (f64, f64) = (0.5, 0.25);

/// Measured columns of a rival on an arm, alongside those that the paper prints.
pub(crate) fn columns(
    arm: &ArmCase,
    entry: &Entry,
    tuning: &TuningRecord,
    share: f64,
    cells: &[LawCell],
) -> MarkColumns {
    let printed = |get: fn(phihat_rivals::Ticks) -> phihat_rivals::Tick| {
        entry.card.printed.map(get).map(Mark::from)
    };
    let measured = |(mark, why): (Mark, String), printed: Option<Mark>| MeasuredTicks {
        mark,
        printed,
        agrees: printed.map(|printed| printed == mark),
        why,
    };
    let span = (arm.study.duration, arm.study.spec.settle);
    let study = arm.in_world(TRAINING[0], ComparisonTask::Score(1), span).ok();
    let condition = study.and_then(|study| promise::condition(arm, entry, &tuning.tuned, &study));
    MarkColumns {
        quantitative: measured(quantitative(cells), printed(|t| t.quantitative)),
        easy: measured(easy(entry, tuning, share), printed(|t| t.easy)),
        optimal: measured(promise::optimal(arm, entry, &tuning.tuned), printed(|t| t.optimal)),
        model_free: measured(model_free(entry), printed(|t| t.model_free)),
        share_of_draws: share,
        scalars: entry.scalars.len(),
        condition,
    }
}

/// Largest bound over measured error that still counts as a statement about the error.
const TIGHT: f64 = 10.0;

/// Mark of the first column, and why: a bound that was computed before the runs with tuned gains, was
/// satisfied in all of them, and is tight. A drive that saturates has no bound: the world that is made for
/// that does not count.
fn quantitative(cells: &[LawCell]) -> (Mark, String) {
    let runs = |gains: GainsKind| {
        let cells = cells.iter().filter(move |c| c.gains == gains && c.world != SATURATION);
        cells.flat_map(|c| &c.runs)
    };
    let ratios = |gains: GainsKind| -> Vec<f64> {
        runs(gains).filter_map(|run| run.figures.as_ref()?.bound_over_measured).collect()
    };
    let held = |ratios: &[f64]| ratios.iter().filter(|r| **r >= 1.0).count();
    let (tuned, first) = (ratios(GainsKind::Tuned), ratios(GainsKind::Default));
    let all = runs(GainsKind::Tuned).count();
    if tuned.is_empty() && first.is_empty() {
        return (Mark::No, "no bound is computed before a run".to_owned());
    }
    if tuned.is_empty() {
        let (stated, held) = (first.len(), held(&first));
        let why = format!(
            "no bound with tuned gains; with the default ones in {stated} of {all} runs, held in {held}"
        );
        return (Mark::Partly, why);
    }
    let least = tuned.iter().copied().fold(f64::INFINITY, f64::min);
    let most = tuned.iter().copied().fold(0.0, f64::max);
    let (stated, held) = (tuned.len(), held(&tuned));
    let mark = if held == all && most <= TIGHT { Mark::Yes } else { Mark::Partly };
    let why = format!(
        "bound computed before {stated} of {all} runs with tuned gains, held in {held}; bound/measured {least:.2} to \
         {most:.3}"
    );
    (mark, why)
}

/// Mark of the column "model free", and why: neither the law nor the choice of its gains uses a model.
fn model_free(entry: &Entry) -> (Mark, String) {
    let handed = format!("handed {}", entry.needs);
    match (entry.needs.model_free(), entry.needs.designed) {
        (false, _) => (Mark::No, handed),
        (true, false) => (Mark::Yes, handed),
        (true, true) => (
            Mark::Partly,
            format!(
                "{handed}; the law has no model, and its design wants the range of the arm's inertia and a bound on \
                 its load, here computed from a model"
            ),
        ),
    }
}

/// Mark of easy tuning, by the share of draws that satisfy the specification, and why.
fn easy(entry: &Entry, tuning: &TuningRecord, share: f64) -> (Mark, String) {
    let mark = match share {
        s if s >= EASY_SHARES.0 => Mark::Yes,
        s if s >= EASY_SHARES.1 => Mark::Partly,
        _ => Mark::No,
    };
    let needed = match tuning.runs_to_spec {
        Some(runs) => format!("tuning met it at run {runs}"),
        None => format!("{} tuning runs did not meet it", tuning.runs),
    };
    let scalars = entry.scalars.len();
    if scalars == 0 {
        let kept = if share > 0.0 { "kept" } else { "did not keep" };
        return (mark, format!("no free scalar; the designed gains {kept} the specification"));
    }
    let percent = 100.0 * share;
    let why =
        format!("{scalars} free scalars; {percent:.0} % of draws keep the specification; {needed}");
    (mark, why)
}
