//! From runs to the table.

use phihat_rivals::{Entry, Tuning};
use toml::Table;

use super::case::{Case, Scored};
use super::ground::{Ground, Task};
use super::plan::{Known, Plan};
use super::prepare::NOISE_CAP;
use super::promise;
use super::record::{Comparison, FORMAT, Fairness, Mark, RivalRecord, WorldRecord};
use super::row::{Cell, Columns, Cost, Fate, Figures, GainsKind, Measured, Row, Run, TuningRecord};
use super::trial::NOMINAL_MASSES;
use super::world::{SATURATION, TRAINING};
use phihat_campaign::Ended;

/// Share of draws from which gains are easy to find, and from which they are partly so.
pub const EASY_SHARES: (f64, f64) = (0.5, 0.25);

/// The whole answer.
pub(crate) fn comparison(
    plan: &Plan,
    known: &[Known],
    cases: &[Case],
    scored: Vec<Ended<Scored>>,
) -> Comparison {
    let mut runs: Vec<(Case, Scored)> =
        cases.iter().copied().zip(scored.into_iter().map(ended)).collect();
    beside_exact(plan, &mut runs);
    let world = |world: &&super::World| WorldRecord {
        name: world.name.to_owned(),
        what: world.what.split_whitespace().collect::<Vec<_>>().join(" "),
    };
    let rival = |entry: &&Entry| RivalRecord::new(entry.card, entry.needs, entry.scalars);
    let row_of = |((ground, rival), known)| row(plan, (ground, rival), known, &runs);
    Comparison {
        format: FORMAT.to_owned(),
        phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
        fairness: fairness(plan),
        arms: plan.grounds.iter().map(Ground::record).collect(),
        worlds: plan.worlds.iter().map(world).collect(),
        rivals: plan.rivals.iter().map(rival).collect(),
        rows: plan.pairs().into_iter().zip(known).map(row_of).collect(),
    }
}

fn ended(ended: Ended<Scored>) -> Scored {
    match ended {
        Ended::With(scored) => scored,
        Ended::Panicked(why) => Scored { fate: Fate::Panicked(why), figures: None, sketch: None },
    }
}

/// Puts the chatter of the exact world beside that of every other.
fn beside_exact(plan: &Plan, runs: &mut [(Case, Scored)]) {
    let exact: Vec<(Case, f64)> = runs
        .iter()
        .filter(|(case, _)| plan.worlds[case.world].name == "exact")
        .filter_map(|(case, scored)| Some((*case, scored.figures.as_ref()?.chatter_nm)))
        .collect();
    for (case, scored) in runs {
        let same = |(other, _): &&(Case, f64)| *other == Case { world: other.world, ..*case };
        if let (Some(figures), Some((_, exact))) = (&mut scored.figures, exact.iter().find(same)) {
            figures.chatter_over_exact = (*exact > 0.0).then(|| figures.chatter_nm / exact);
        }
    }
}

fn row(
    plan: &Plan,
    (ground, rival): (usize, usize),
    known: &Known,
    runs: &[(Case, Scored)],
) -> Row {
    let (arm, entry) = (&plan.grounds[ground], plan.rivals[rival]);
    let mut row = Row {
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
            row.refused = Some(why.clone());
            return row;
        }
    };
    for world in 0..plan.worlds.len() {
        for gains in [GainsKind::Default, GainsKind::Tuned] {
            let own = runs.iter().filter(|(case, _)| {
                (case.ground, case.rival, case.world, case.gains) == (ground, rival, world, gains)
            });
            row.cells.push(cell(plan, plan.worlds[world].name, gains, own));
        }
    }
    row.columns = Some(columns(arm, entry, tuning, known.share, &row.cells));
    row.cost = cost(arm, entry, tuning);
    row.tuning = Some(tuning.clone());
    row
}

fn cell<'r>(
    plan: &Plan,
    world: &str,
    gains: GainsKind,
    own: impl Iterator<Item = &'r (Case, Scored)>,
) -> Cell {
    let own: Vec<_> = own.collect();
    let run = |(case, scored): &&(Case, Scored)| Run {
        name: plan.name(case),
        seed: case.seed,
        fate: scored.fate.clone(),
        figures: scored.figures.clone(),
    };
    let fates = own.iter().map(|(_, scored)| &scored.fate);
    let figures = own.iter().filter_map(|(_, scored)| scored.figures.as_ref());
    Cell {
        world: world.to_owned(),
        gains,
        runs: own.iter().map(run).collect(),
        worst: figures.cloned().reduce(|a, b| worse(&a, &b)),
        fate: fates.max_by_key(|fate| fate.badness()).cloned().unwrap_or(Fate::Followed),
        sketch: own.iter().find_map(|(_, scored)| scored.sketch.clone()),
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
        error_max_rad: a.error_max_rad.max(b.error_max_rad),
        error_over_spec: a.error_over_spec.max(b.error_over_spec),
        effort: a.effort.max(b.effort),
        chatter_nm: a.chatter_nm.max(b.chatter_nm),
        chatter_over_exact: more(a.chatter_over_exact, b.chatter_over_exact),
        noise: a.noise.max(b.noise),
        saturated: a.saturated.max(b.saturated),
        // One that did not come back is the worst.
        recovery_s: a.recovery_s.zip(b.recovery_s).map(|(a, b)| a.max(b)),
        bound_rad: tightest.and_then(|f| f.bound_rad),
        bound_over_measured: tightest.and_then(|f| f.bound_over_measured),
    }
}

fn cost(arm: &Ground, entry: &Entry, tuning: &TuningRecord) -> Option<Cost> {
    let period = arm.study.control.period_ns as f64 * 1e-9;
    let values = Tuning::new(&tuning.tuned, &arm.units, period).ok()?;
    let supply = arm.supply(entry, &arm.study).ok()?;
    let states = entry.build(&values, &supply).ok()?.states();
    Some(Cost { states, instructions: instructions(&arm.study.robot.name, entry.card.id) })
}

/// Instructions of an update, as they were last counted on an arm; `None` where they were not.
fn instructions(robot: &str, rival: &str) -> Option<u64> {
    let counted: Table = include_str!("instructions.toml").parse().ok()?;
    counted.get(robot)?.get(rival)?.as_integer()?.try_into().ok()
}

fn columns(
    arm: &Ground,
    entry: &Entry,
    tuning: &TuningRecord,
    share: f64,
    cells: &[Cell],
) -> Columns {
    let printed = |get: fn(phihat_rivals::Ticks) -> phihat_rivals::Tick| {
        entry.card.printed.map(get).map(Mark::from)
    };
    let measured = |(mark, why): (Mark, String), printed: Option<Mark>| Measured {
        mark,
        printed,
        agrees: printed.map(|printed| printed == mark),
        why,
    };
    let span = (arm.study.duration, arm.study.spec.settle);
    let study = arm.in_world(TRAINING[0], Task::Score(1), span).ok();
    let condition = study.and_then(|study| promise::condition(arm, entry, &tuning.tuned, &study));
    Columns {
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

/// Whether a bound was computed before the runs with tuned gains, whether it held in all of them, and how tight it is.
/// A drive that saturates has none: the world that is made for that does not count.
fn quantitative(cells: &[Cell]) -> (Mark, String) {
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

/// Whether the law, or whoever chose its gains, knew a model of the arm.
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

/// How much of the gains' neighbourhood keeps the specification.
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

fn fairness(plan: &Plan) -> Fairness {
    let extent = &plan.extent;
    let scored = (0..plan.grounds.len()).map(|g| plan.span(g)).map(|(end, from)| end - from);
    Fairness {
        optimiser: "CMA-ES in the logarithms of the free scalars, from the default values"
            .to_owned(),
        tuning_runs: extent.tuning_runs,
        training: (
            usize::try_from(extent.training_motions).unwrap_or(usize::MAX),
            extent.training_s,
        ),
        training_worlds: TRAINING.map(|world| world.name.to_owned()).to_vec(),
        seeds: extent.seeds,
        scored_s: scored.fold(0.0, f64::max),
        nominal_masses: NOMINAL_MASSES,
        noise_cap: NOISE_CAP,
        draws: extent.draws,
        notes: notes(),
    }
}

fn notes() -> Vec<String> {
    [
        "Every rival is tuned once per arm, not once per world, with the same optimiser, number of evaluations \
         and seed, from its default gains, inside ranges around them. The cost is the rms error of the worst \
         joint; gains whose torque noise is above the cap are worse than all that keep it, the more the noisier; \
         a run that does not follow, or meets the torque limits in more than 2 % of its samples, is worse than \
         any noise; a run that ends early is worse than all that do not, the more the sooner.",
        "Motions that are trained on are not scored on. Training is in two worlds, friction and payload, so that gains \
         have to bear the arm with and without its load; the other worlds are met for the first time when they are \
         scored.",
        "Every rival gets the same nominal inertia per joint as the unit of its torque gains. Rivals that need \
         a model get the arm's own with lighter links, without payload and without dry friction.",
        "The row with designed gains is not tuned: its gains come from the specification, the study's loop, the range \
         of inertia with and without payload, and the load along the study's own motion. Neither the drawn motions nor \
         the dry friction of the worlds were declared to the design: there its bound, computed for that very run, may be \
         beyond the specification.",
        "A law with more free scalars gets no more evaluations: a law with many may be better than its row. \
         Where an author's tuning procedure is not a choice of scalars, it is not followed.",
        "Bounds are asked for where the declared load fits the torque limits: none is asked for a drive that saturates.",
        "Bounds: that of this project's law, and of the disturbance observer which is the same law, counts encoder, \
         filter, delay and the range of inertia. Those of other laws are the formulas of their proofs, which mostly do \
         not: a broken one shows that, and not that the law is the worse one. Where none is computed the authors may \
         have one. A full mark is for a bound that held in every run but those made to saturate, and was nowhere more \
         than ten times the error.",
        "Tuned gains can be worse than the default ones: where these are noisier than the cap, and on motions unlike \
         those that were trained on. Both are in the data.",
        "A law that follows a path and no time table is judged by its distance to the path.",
        "To follow is not to be quiet: a torque that jumps from limit to limit can hold an arm on its path. \
         Chatter and noise show it.",
        "The specification decides what share of draws is easy. Another specification gives other shares.",
        "This project chose the arms, worlds and cost, and knows its own law best.",
    ]
    .map(|note| note.split_whitespace().collect::<Vec<_>>().join(" "))
    .to_vec()
}
