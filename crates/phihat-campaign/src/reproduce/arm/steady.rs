//! Figs. 7 and 11: the errors of the steady part against (48) and (49).

use phihat_design::requested_gains;
use phihat_design::sampled::{LoopModel, SampledPeaks};
use phihat_study::LawForm;

use super::claims::{BOUNDS, keeps_bounds, verdict};
use super::run::Run;
use super::runs::{FORMS, Runs, form_name};
use super::studies::Setting;
use crate::reproduce::compose::{
    axis, bound, curve, figure, lines, number, section, statement, table, three,
};
use crate::reproduce::{Figure, Section, Statement, Table};

/// Tolerance of our own figures on another machine.
const AGAIN: f64 = 1e-2;

/// What errors count as "much smaller" than a bound.
const MUCH: f64 = 10.0;

/// Which of the paper's two figures.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shown {
    pub(crate) figure: &'static str,
    pub(crate) id: &'static str,
    pub(crate) table: &'static str,
}

/// Fig. 7.
pub(crate) const SIMULATED: Shown =
    Shown { figure: "Fig. 7", id: "fig7", table: "steady-simulation" };
/// Fig. 11.
pub(crate) const EXPERIMENTED: Shown =
    Shown { figure: "Fig. 11", id: "fig11", table: "steady-experiment" };

/// Fig. 7: the bounds, and how much smaller the errors are.
pub(crate) fn simulated(runs: &Runs) -> Result<Section, String> {
    let text = "The bounds of (48), for m = 1: |∫e| ≤ 10⁻³ rad·s, |e| ≤ 10⁻² rad, |ė| ≤ 10⁻¹ rad/s; of \
                (49), for m = 2, the same and |∬e| ≤ 10⁻⁴ rad·s². They are looked at after the 1.5 s of \
                the transient.";
    let mut section = section("figure-7", "Fig. 7: errors in the steady part, simulation", &[text]);
    section.statements.push(kept(runs, SIMULATED, &[Setting::First])?);
    section.statements.push(kept(runs, SIMULATED, &Setting::SECOND)?);
    section.statements.push(margin(runs)?);
    section.tables.push(steady_table(runs, SIMULATED));
    section.figures.push(errors_figure("fig-07", "Fig. 7: errors in simulation", runs)?);
    Ok(section)
}

/// Whether the bounds of some settings are kept: in the printed form, else in observer form.
pub(crate) fn kept(runs: &Runs, shown: Shown, settings: &[Setting]) -> Result<Statement, String> {
    let order = if settings == [Setting::First] { 1 } else { 2 };
    let all = |form: LawForm| -> Result<bool, String> {
        let kept = settings.iter().map(|s| Ok(keeps_bounds(runs.get(*s, form)?, *s)));
        Ok(kept.collect::<Result<Vec<_>, String>>()?.into_iter().all(|kept| kept))
    };
    let (literal, observer) = (all(LawForm::Literal)?, all(LawForm::Observer)?);
    let worst = |form: LawForm| -> Result<Option<[f64; 4]>, String> {
        let mut worst = [0.0_f64; 4];
        for setting in settings {
            let Some(steady) = runs.get(*setting, form)?.steady() else { return Ok(None) };
            worst = core::array::from_fn(|i| worst[i].max(steady[i]));
        }
        Ok(Some(worst))
    };
    let (printed, ours) = (worst(LawForm::Literal)?, worst(LawForm::Observer)?);
    let why = match (literal, observer) {
        (true, true) => {
            "The printed form keeps them, and so does the observer form, whose ∫e is counted from the \
             steady part on: it has no integral of the error, and what the transient added to ∫e stays."
        }
        (true, false) => {
            "The printed form keeps them. The observer form, with the same gains, does not."
        }
        (false, true) => {
            "The printed form does not keep them; the observer form, fed with the torque that acted, keeps \
             |e|, |ė| and |∫e| counted from the steady part on. ∬e is no state of it and is not judged."
        }
        (false, false) => "Neither form keeps them with these gains on this arm.",
    };
    let name = |what: &str, form: &str| {
        format!("largest |{what}| of the steady part, m = {order}, {form}")
    };
    let numbers =
        [(printed, "literal"), (ours, "observer")].into_iter().flat_map(|(worst, form)| {
            ["∫e", "e", "ė"].into_iter().zip(["rad·s", "rad", "rad/s"]).enumerate().map(
                move |(i, (what, unit))| {
                    number(&name(what, form), unit, worst.map(|worst| worst[i + 1]), AGAIN)
                },
            )
        });
    Ok(statement(
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
        verdict(literal, observer),
        (
            format!("printed form: {}; observer form: {}", as_words(printed), as_words(ours)),
            why.to_owned(),
        ),
        numbers.collect(),
    ))
}

fn as_words(worst: Option<[f64; 4]>) -> String {
    worst.map_or("diverged".to_owned(), |[_, once, e, de]| {
        format!("|∫e| {}, |e| {}, |ė| {}", three(Some(once)), three(Some(e)), three(Some(de)))
    })
}

/// "The maximum error is much smaller than the threshold", and what would have been promised.
fn margin(runs: &Runs) -> Result<Statement, String> {
    let run = runs.get(Setting::First, LawForm::Literal)?;
    let most = |setting: &Setting| {
        Ok(runs.get(*setting, LawForm::Literal)?.steady().map(|steady| steady[2]))
    };
    let errors: Vec<Option<f64>> = Setting::ALL.iter().map(most).collect::<Result<_, String>>()?;
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
    ))
}

/// What a run's largest φ can do to `e` \[rad\], by the peak-to-peak gain of its sampled loop.
pub(crate) fn error_bound(run: &Run) -> Result<f64, String> {
    let gains = requested_gains(&run.study).ok_or("the study states no gains")?;
    let record = gains.joints.first().ok_or("the robot has no joint")?;
    let peaks = SampledPeaks::at(record, &LoopModel::from_study(&run.study, 0), 1.0);
    let peaks = peaks.map_err(|why| why.to_string())?;
    Ok(peaks.jump[1] * run.phi_max() / record.inertia_kg_m2)
}

/// The ladder of every run.
pub(crate) fn steady_table(runs: &Runs, shown: Shown) -> Table {
    let row = |(setting, form, run): (Setting, LawForm, &Run)| {
        let mut row = vec![setting.label().to_owned(), form_name(form).to_owned()];
        match run.steady() {
            Some(steady) => row.extend(steady.iter().map(|value| three(Some(*value)))),
            None => row.extend(["diverged", "", "", ""].map(str::to_owned)),
        }
        row.push(if keeps_bounds(run, setting) { "yes" } else { "no" }.to_owned());
        row
    };
    let columns =
        ["gains", "form", "|∬e| [rad·s²]", "|∫e| [rad·s]", "|e| [rad]", "|ė| [rad/s]", "kept"];
    let title = format!("Largest errors of the steady part, {}", shown.figure);
    table(shown.table, &title, &columns, runs.iter().map(row).collect())
}

/// Errors of every joint over the steady part: m = 1 and H3, both forms.
pub(crate) fn errors_figure(id: &str, title: &str, runs: &Runs) -> Result<Figure, String> {
    let mut panels = Vec::new();
    for form in FORMS {
        for setting in [Setting::First, Setting::H3] {
            let run = runs.get(setting, form)?;
            let from = run.steady_from();
            let joint = |(i, joint): (usize, &phihat_sim::JointTrace)| {
                let points = run.times().zip(&joint.e).skip(from).map(|(t, e)| [t, e * 1e3]);
                curve(&format!("q_{}", i + 1), points)
            };
            let series = run.joints().iter().enumerate().map(joint).collect();
            let kept = vec![bound("(48), (49)", BOUNDS[2] * 1e3)];
            let title = format!("{}, {} form", setting.label(), form_name(form));
            panels.push(lines(&title, (axis("t [s]"), axis("e [mrad]")), series, kept));
        }
    }
    let caption = "Errors of the three joints after the transient, and the bound that the paper states for them.";
    Ok(figure(id, title, caption, panels))
}
