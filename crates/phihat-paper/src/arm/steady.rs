//! Figs. 7 and 11: the errors of the steady part against (48) and (49).

use phihat::Form;
use phihat_design::prelude::*;
use phihat_design::requested_gains;
use phihat_design::sampled::{LoopModel, SampledPeaks};

use super::claims::{BOUNDS, KEEPS, keeps_bounds, verdict};
use super::errors::errors_figure;
use super::run::Run;
use super::runs::{Runs, form_name};
use super::saturation::{thresholds, turning};
use super::start_map::{StartMap, StartOutcome};
use super::studies::GainSetting;
use super::surrogates::Varied;
use crate::compose::{number, section, statement, table, three};
use crate::item::{Item, Kind};
use crate::part::PartError;
use crate::record::{PaperNumber, Section, Statement, Table};

/// Tolerance of our own figures on another machine.
const AGAIN: f64 = 1e-2;

/// Bound over error from which on an error counts as "much smaller".
const MUCH: f64 = 10.0;

/// One of the paper's two figures.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SteadyFigure {
    pub(crate) figure: &'static str,
    pub(crate) id: &'static str,
    pub(crate) table: &'static str,
}

/// Fig. 7.
pub(crate) const SIMULATED: SteadyFigure =
    SteadyFigure { figure: "Fig. 7", id: "fig7", table: "steady-simulation" };
/// Fig. 11.
pub(crate) const EXPERIMENTED: SteadyFigure =
    SteadyFigure { figure: "Fig. 11", id: "fig11", table: "steady-experiment" };

/// Fig. 7: the bounds, and how much smaller the errors are.
pub(crate) fn simulated(runs: &Runs) -> Result<Section, PartError> {
    let text = "The bounds of (48), for m = 1: |∫e| ≤ 10⁻³ rad·s, |e| ≤ 10⁻² rad, |ė| ≤ 10⁻¹ rad/s; of \
                (49), for m = 2, the same and |∬e| ≤ 10⁻⁴ rad·s². They are looked at after the 1.5 s of \
                the transient, with integrals counted from there on in either form.";
    let mut section = section("figure-7", "Fig. 7: errors in the steady part, simulation", &[text]);
    section.statements.push(kept(runs, SIMULATED, &[GainSetting::First], None)?);
    section.statements.push(kept(runs, SIMULATED, &GainSetting::SECOND, None)?);
    section.statements.push(margin(runs)?);
    section.tables.push(steady_table(runs, SIMULATED));
    section.figures.push(errors_figure("fig-07", "Fig. 7: errors in simulation", runs)?);
    Ok(section)
}

/// The quantities of (48) and (49) with their units, in the order of [`BOUNDS`].
const LADDER: [(&str, &str); 4] = [("∬e", "rad·s²"), ("∫e", "rad·s"), ("e", "rad"), ("ė", "rad/s")];

/// Statement that some settings satisfy their bounds, in either form, integrals counted alike.
///
/// An experiment that fails from every start is open, whatever the observer form does.
pub(crate) fn kept(
    runs: &Runs,
    shown: SteadyFigure,
    settings: &[GainSetting],
    open: Option<(&Varied, &StartMap)>,
) -> Result<Statement, PartError> {
    let order = if settings == [GainSetting::First] { 1 } else { 2 };
    let all = |form: Form| -> Result<bool, PartError> {
        let kept = settings.iter().map(|s| Ok(keeps_bounds(runs.get(*s, form)?, *s)));
        Ok(kept.collect::<Result<Vec<_>, PartError>>()?.into_iter().all(|kept| kept))
    };
    let (printed, observer) = (all(Form::Literal)?, all(Form::Observer)?);
    let worst = |form: Form, of: fn(&Run) -> Option<[f64; 4]>| -> Result<_, PartError> {
        let mut worst = [0.0_f64; 4];
        for setting in settings {
            let Some(steady) = of(runs.get(*setting, form)?) else { return Ok(None) };
            worst = core::array::from_fn(|i| worst[i].max(steady[i]));
        }
        Ok::<_, PartError>(Some(worst))
    };
    let both = [worst(Form::Literal, Run::steady)?, worst(Form::Observer, Run::steady)?];
    let own = worst(Form::Literal, Run::since_start)?;
    let claim = KEEPS[order - 1];
    let mut numbers = ladder_numbers(order, both, own);
    let settled = [StartOutcome::Soon, StartOutcome::Late];
    let elsewhere = open.is_some_and(|(_, map)| map.somewhere(settings, &settled));
    let verdict = verdict(printed || elsewhere, observer && open.is_none());
    let depends = open.map(|(varied, map)| {
        numbers.extend(varied.counts(claim, "it holds"));
        numbers.extend(thresholds(map, settings));
        varied.depends(claim)
    });
    let whole = statement(
        [
            &format!("{}-m{order}", shown.id),
            shown.figure,
            &format!("With m = {order} the errors of the steady part keep ({}).", 47 + order),
            if order == 1 {
                "(10⁻³, 10⁻², 10⁻¹)"
            } else {
                "(10⁻⁴, 10⁻³, 10⁻², 10⁻¹)"
            },
        ],
        verdict,
        (
            format!(
                "printed form: {}; observer form: {}",
                as_words(order, both[0]),
                as_words(order, both[1])
            ),
            why([printed, observer], order, own, elsewhere),
        ),
        numbers,
    );
    Ok(read(whole, (order, settings), open.map(|(_, map)| (map, depends.unwrap_or_default()))))
}

/// Adds how the statement was read, what was varied and where it turns; for an experiment, from the map and the
/// effect of the other assumptions.
fn read(
    statement: Statement,
    (order, settings): (usize, &[GainSetting]),
    experiment: Option<(&StartMap, String)>,
) -> Statement {
    let statement = statement.covering(&[
        Item { kind: Kind::Equation, number: if order == 1 { 48 } else { 49 } },
        Item { kind: Kind::Figure, number: if experiment.is_some() { 11 } else { 7 } },
    ]);
    let Some((map, depends)) = experiment else {
        return statement.read_as(
            "Printed form, all gain sets of the order: largest errors after 1.5 s, integrals counted from there on.",
        );
    };
    statement
        .read_as(
            "Largest errors of the second turn, integrals counted from its beginning. It counts as printed where every \
             gain set keeps the bounds in the printed form with the assumed limit from one of the starts of the map.",
        )
        .varying(format!("Start and limit together (the map). {depends}"))
        .turning(turning(map, settings))
}

/// The quantities that (48) or (49) bounds.
fn first_of(order: usize) -> usize {
    2_usize.saturating_sub(order)
}

fn ladder_numbers(
    order: usize,
    both: [Option<[f64; 4]>; 2],
    own: Option<[f64; 4]>,
) -> Vec<PaperNumber> {
    let names = ["printed form", "observer form"];
    let mut numbers = Vec::new();
    for (form, worst) in names.into_iter().zip(both) {
        for (i, (what, unit)) in LADDER.into_iter().enumerate().skip(first_of(order)) {
            let name = format!("largest |{what}| of the steady part, m = {order}, {form}");
            numbers.push(number(&name, unit, worst.map(|worst| worst[i]), AGAIN));
        }
    }
    for (i, (what, unit)) in LADDER.into_iter().enumerate().take(2).skip(first_of(order)) {
        let name =
            format!("the same of |{what}| since the first sample, m = {order}, printed form");
        numbers.push(number(&name, unit, own.map(|own| own[i]), AGAIN));
    }
    numbers
}

fn why(
    [printed, observer]: [bool; 2],
    order: usize,
    own: Option<[f64; 4]>,
    elsewhere: bool,
) -> String {
    let verdict = match (printed, observer) {
        (true, true) => "Both forms keep them.",
        (true, false) => {
            "The printed form keeps them; the observer form, with the same gains, does not."
        }
        (false, true) => {
            "The printed form does not keep them; the observer form, fed with the torque that acted, does."
        }
        (false, false) if order == 2 => {
            "Neither form keeps them here. The observer form has no integral of the error to bring back: its ∬e \
             goes on with whatever ∫e it is left with."
        }
        (false, false) => "Neither form keeps them with these gains on this arm.",
    };
    let counted =
        "Integrals are counted from the beginning of the steady part, in both forms alike";
    let own = own.filter(|_| printed).map_or(String::new(), |own| {
        let states = LADDER.iter().zip(own).take(2).skip(first_of(order));
        let states = states.map(|((what, _), value)| format!("|{what}| {}", three(Some(value))));
        let states: Vec<String> = states.collect();
        format!(
            "; those that the printed form has carried since the first sample are {}",
            states.join(", ")
        )
    });
    let open = if printed || !elsewhere {
        ""
    } else {
        " That is from the start of the studies: from nearer ones, which the paper does not exclude, the printed form \
         keeps them under the same limit."
    };
    format!("{verdict} {counted}{own}.{open}")
}

fn as_words(order: usize, worst: Option<[f64; 4]>) -> String {
    worst.map_or("diverged".to_owned(), |worst| {
        let words = LADDER.iter().zip(worst).skip(first_of(order));
        let words = words.map(|((what, _), value)| format!("|{what}| {}", three(Some(value))));
        words.collect::<Vec<_>>().join(", ")
    })
}

/// "The maximum error is much smaller than the threshold", and what would have been promised.
fn margin(runs: &Runs) -> Result<Statement, PartError> {
    let run = runs.get(GainSetting::First, Form::Literal)?;
    let most = |setting: &GainSetting| {
        Ok(runs.get(*setting, Form::Literal)?.steady().map(|steady| steady[2]))
    };
    let errors: Vec<Option<f64>> =
        GainSetting::ALL.iter().map(most).collect::<Result<_, PartError>>()?;
    let worst = errors
        .iter()
        .copied()
        .collect::<Option<Vec<f64>>>()
        .map(|e| e.into_iter().fold(0.0, f64::max));
    let share = worst.map(|worst| BOUNDS[2] / worst);
    let promised = error_bound(run)?;
    let much = share.is_some_and(|share| share >= MUCH);
    Ok(statement(
        [
            "fig7-margin",
            "Sec. VII-A",
            "The largest error is much smaller than its bound of 0.01 rad.",
            "in words",
        ],
        verdict(much, false),
        (
            format!("{} rad at most, bound/measured = {}", three(worst), three(share)),
            format!(
                "The path is slow and |φ| is {} N·m at most. The peak-to-peak gain of the sampled loop at \
                 μ = 1 promises |e| ≤ {} rad for such a φ at m = 1.",
                three(Some(run.phi_max())),
                three(Some(promised))
            ),
        ),
        vec![
            number("largest |e| of the steady part", "rad", worst, AGAIN),
            number("largest |φ| of the steady part, m = 1", "N·m", run.phi_max(), AGAIN),
            number("bound on |e| from |φ|, m = 1", "rad", promised, AGAIN),
        ],
    )
    .read_as(format!("Printed form, all gain sets: much smaller is {MUCH} times or more."))
    .varying("The gains: m = 1 and all hypotheses of m = 2.")
    .turning(format!(
        "At errors {} times as large.",
        three(share.map(|share| share / MUCH))
    ))
    .covering(&[Item { kind: Kind::Figure, number: 7 }]))
}

/// Bound on `e` for the largest φ of a run \[rad\], by the peak-to-peak gain of its sampled loop.
pub(crate) fn error_bound(run: &Run) -> Result<f64, PartError> {
    let gains =
        requested_gains(&run.study).ok_or(PartError::Missing("the study states no gains"))?;
    let record = gains.joints.first().ok_or(PartError::Missing("the robot has no joint"))?;
    let peaks = SampledPeaks::at(record, &LoopModel::from_study(&run.study, 0), 1.0);
    let peaks = peaks?;
    Ok(peaks.jump[1] * run.phi_max() / record.inertia_kg_m2)
}

/// The ladder of every run.
pub(crate) fn steady_table(runs: &Runs, shown: SteadyFigure) -> Table {
    let row = |(setting, form, run): (GainSetting, Form, &Run)| {
        let mut row = vec![setting.label().to_owned(), form_name(form).to_owned()];
        match run.steady() {
            Some(steady) => row.extend(steady.iter().enumerate().map(|(i, value)| {
                let judged = i >= usize::from(setting == GainSetting::First);
                if judged { three(Some(*value)) } else { "not in (48)".to_owned() }
            })),
            None => row.extend(["diverged", "", "", ""].map(str::to_owned)),
        }
        let bounds = if setting == GainSetting::First { "(48)" } else { "(49)" };
        let kept = if keeps_bounds(run, setting) { "yes" } else { "no" };
        row.push(format!("{bounds}: {kept}"));
        row
    };
    let columns =
        ["gains", "form", "|∬e| [rad·s²]", "|∫e| [rad·s]", "|e| [rad]", "|ė| [rad/s]", "kept"];
    let title = format!(
        "Largest errors of the steady part, integrals counted from its beginning, {}",
        shown.figure
    );
    table(shown.table, &title, &columns, runs.iter().map(row).collect())
}
