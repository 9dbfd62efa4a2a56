//! From runs to the table.

use phihat_campaign::RunEnded;
use phihat_rivals::{Entry, Tuning};
use toml::Table;

use crate::arm_case::ArmCase;
use crate::case::{ComparisonCase, Scored};
use crate::columns::columns;
use crate::fairness::fairness;
use crate::plan::ComparisonPlan;
use crate::prepare::Preparation;
use crate::record::{Comparison, FORMAT, RivalRecord, WorldRecord};
use crate::row::{GainsKind, LawCell, LawRow, LawRun, TuningCost, TuningRecord};
use crate::run_outcome::{Figures, RunOutcome};
use crate::world::ComparisonWorld;

/// The whole answer.
pub(crate) fn comparison(
    plan: &ComparisonPlan,
    known: &[Preparation],
    cases: &[ComparisonCase],
    scored: Vec<RunEnded<Scored>>,
) -> Comparison {
    let mut runs: Vec<(ComparisonCase, Scored)> =
        cases.iter().copied().zip(scored.into_iter().map(ended)).collect();
    beside_exact(plan, &mut runs);
    let world = |world: &&ComparisonWorld| WorldRecord {
        name: world.name.to_owned(),
        what: world.what.split_whitespace().collect::<Vec<_>>().join(" "),
    };
    let rival = |entry: &&Entry| RivalRecord::new(entry.card, entry.needs, entry.scalars);
    let row_of = |((arm, rival), known)| row(plan, (arm, rival), known, &runs);
    Comparison {
        format: FORMAT.to_owned(),
        phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
        fairness: fairness(plan),
        arms: plan.arms.iter().map(ArmCase::record).collect(),
        worlds: plan.worlds.iter().map(world).collect(),
        rivals: plan.rivals.iter().map(rival).collect(),
        rows: plan.pairs().into_iter().zip(known).map(row_of).collect(),
    }
}

fn ended(ended: RunEnded<Scored>) -> Scored {
    match ended {
        RunEnded::With(scored) => scored,
        RunEnded::Panicked(why) => {
            Scored { outcome: RunOutcome::Panicked(why), figures: None, sketch: None }
        }
    }
}

/// Sets the chatter of every run over that in the exact world.
fn beside_exact(plan: &ComparisonPlan, runs: &mut [(ComparisonCase, Scored)]) {
    let exact: Vec<(ComparisonCase, f64)> = runs
        .iter()
        .filter(|(case, _)| plan.worlds[case.world].name == "exact")
        .filter_map(|(case, scored)| Some((*case, scored.figures.as_ref()?.chatter_nm)))
        .collect();
    for (case, scored) in runs {
        let same = |(other, _): &&(ComparisonCase, f64)| {
            *other == ComparisonCase { world: other.world, ..*case }
        };
        if let (Some(figures), Some((_, exact))) = (&mut scored.figures, exact.iter().find(same)) {
            figures.chatter_over_exact = (*exact > 0.0).then(|| figures.chatter_nm / exact);
        }
    }
}

fn row(
    plan: &ComparisonPlan,
    (place, rival): (usize, usize),
    known: &Preparation,
    runs: &[(ComparisonCase, Scored)],
) -> LawRow {
    let (arm, entry) = (&plan.arms[place], plan.rivals[rival]);
    let mut row = LawRow {
        arm: arm.name.clone(),
        rival: entry.card.id.to_owned(),
        refused: None,
        tuning: None,
        columns: None,
        cost: None,
        cells: Vec::new(),
    };
    let tuning = match &known.tuning {
        Ok(tuning) => tuning,
        Err(why) => {
            row.refused = Some(why.to_string());
            return row;
        }
    };
    for world in 0..plan.worlds.len() {
        for gains in [GainsKind::Default, GainsKind::Tuned] {
            let of_cell = runs.iter().filter(|(case, _)| {
                (case.arm, case.rival, case.world, case.gains) == (place, rival, world, gains)
            });
            row.cells.push(cell(plan, plan.worlds[world].name, gains, of_cell));
        }
    }
    row.columns = Some(columns(arm, entry, tuning, known.share, &row.cells));
    row.cost = cost(arm, entry, tuning);
    row.tuning = Some(tuning.clone());
    row
}

fn cell<'r>(
    plan: &ComparisonPlan,
    world: &str,
    gains: GainsKind,
    runs: impl Iterator<Item = &'r (ComparisonCase, Scored)>,
) -> LawCell {
    let runs: Vec<_> = runs.collect();
    let run = |(case, scored): &&(ComparisonCase, Scored)| LawRun {
        name: plan.name(case),
        seed: case.seed,
        outcome: scored.outcome.clone(),
        figures: scored.figures.clone(),
    };
    let outcomes = runs.iter().map(|(_, scored)| &scored.outcome);
    let figures = runs.iter().filter_map(|(_, scored)| scored.figures.as_ref());
    LawCell {
        world: world.to_owned(),
        gains,
        runs: runs.iter().map(run).collect(),
        worst: figures.cloned().reduce(|a, b| worse(&a, &b)),
        outcome: outcomes
            .max_by_key(|outcome| outcome.badness())
            .cloned()
            .unwrap_or(RunOutcome::Followed),
        sketch: runs.iter().find_map(|(_, scored)| scored.sketch.clone()),
    }
}

/// The worse of every figure.
fn worse(a: &Figures, b: &Figures) -> Figures {
    let more = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a.max(b)).or(a).or(b);
    let bounds = [a, b].into_iter().filter(|f| f.bound_over_measured.is_some());
    let tight = |f: &&Figures| f.bound_over_measured.unwrap_or(f64::INFINITY);
    let tightest = bounds.min_by(|a, b| tight(a).total_cmp(&tight(b)));
    Figures {
        error_rms_rad: a.error_rms_rad.max(b.error_rms_rad),
        error_peak_rad: a.error_peak_rad.max(b.error_peak_rad),
        error_over_spec: a.error_over_spec.max(b.error_over_spec),
        effort: a.effort.max(b.effort),
        chatter_nm: a.chatter_nm.max(b.chatter_nm),
        chatter_over_exact: more(a.chatter_over_exact, b.chatter_over_exact),
        noise: a.noise.max(b.noise),
        noise_above_50_hz: more(a.noise_above_50_hz, b.noise_above_50_hz),
        saturated: a.saturated.max(b.saturated),
        // One that did not come back is the worst.
        recovery_s: a.recovery_s.zip(b.recovery_s).map(|(a, b)| a.max(b)),
        error_bound_rad: tightest.and_then(|f| f.error_bound_rad),
        bound_over_measured: tightest.and_then(|f| f.bound_over_measured),
    }
}

fn cost(arm: &ArmCase, entry: &Entry, tuning: &TuningRecord) -> Option<TuningCost> {
    // What a law of somebody's own remembers is not known.
    if !entry.edition.is_empty() {
        return None;
    }
    let period = arm.study.control.period_ns as f64 * 1e-9;
    let values = Tuning::new(&tuning.tuned, &arm.units, period).ok()?;
    let supply = arm.supply(entry, &arm.study).ok()?;
    let states = entry.build(&values, &supply).ok()?.states();
    Some(TuningCost { states, instructions: instructions(&arm.study.robot.name, entry.card.id) })
}

/// Instructions of an update, as they were last counted on an arm; `None` where they were not.
fn instructions(robot: &str, rival: &str) -> Option<u64> {
    let counted: Table = include_str!("instructions.toml").parse().ok()?;
    counted.get(robot)?.get(rival)?.as_integer()?.try_into().ok()
}
