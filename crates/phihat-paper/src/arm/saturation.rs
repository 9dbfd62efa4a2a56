//! What a torque limit does to the transient, and how much torque the transient needs.

use super::claims::{SETTLES, verdict};
use super::runs::{FORMS, Runs, form_name};
use super::studies::{Kind, Setting, Studies};
use super::surrogates::Varied;
use super::variations::limited;
use crate::compose::{axis, curve, figure, lines, log_axis, number, statement, three};
use crate::part::{Extent, PartError};
use crate::record::{Figure, Statement, Verdict};
use phihat::Form;

/// Torque limits that are tried \[N·m\].
const LIMITS: &[f64] =
    &[20.0, 35.0, 50.0, 75.0, 100.0, 150.0, 200.0, 400.0, 800.0, 1600.0, 3200.0, 6400.0, 12800.0];

/// A transient this many times as long as without the limit is a long one.
const LONG: f64 = 1.5;

/// When each setting settles, per form and limit \[s\].
pub(crate) type Settling = Vec<(Setting, Form, Vec<(f64, Option<f64>)>)>;

/// Every setting in both forms at every limit.
pub(crate) fn sweep(
    studies: &Studies,
    extent: Extent,
    progress: &dyn Fn(f64),
) -> Result<Settling, PartError> {
    let every = if extent.quick { 4 } else { 1 };
    let limits: Vec<f64> = LIMITS.iter().copied().step_by(every).collect();
    let mut settling: Settling = Setting::ALL
        .iter()
        .flat_map(|setting| FORMS.map(|form| (*setting, form, Vec::new())))
        .collect();
    for (k, limit) in limits.iter().enumerate() {
        let runs = Runs::of(studies, Kind::Experiment, |study| limited(study, *limit), || ())?;
        for (setting, form, times) in &mut settling {
            times.push((*limit, runs.get(*setting, *form)?.settled_at()));
        }
        progress((k + 1) as f64 / limits.len() as f64);
    }
    Ok(settling)
}

/// Longest time to settle over the settings \[s\]; `None` where one does not.
fn slowest(runs: &Runs, form: Form) -> Result<Option<f64>, PartError> {
    let at = |setting: &Setting| Ok(runs.get(*setting, form)?.settled_at());
    let all: Vec<Option<f64>> = Setting::ALL.iter().map(at).collect::<Result<_, PartError>>()?;
    let all: Option<Vec<f64>> = all.into_iter().collect();
    Ok(all.map(|all| all.into_iter().fold(0.0, f64::max)))
}

/// "The long transient is because of the torque saturation".
pub(crate) fn long_transient(
    runs: &Runs,
    free: &Runs,
    swept: &Settling,
) -> Result<Statement, PartError> {
    let times =
        |form: Form| -> Result<_, PartError> { Ok((slowest(runs, form)?, slowest(free, form)?)) };
    let (printed, observer) = (times(Form::Literal)?, times(Form::Observer)?);
    let is_long = |with: f64, without: Option<f64>| without.is_some_and(|at| with >= LONG * at);
    // At which of the limits tried the printed form settles, and late.
    let mut elsewhere = Vec::new();
    for setting in Setting::ALL {
        let without = free.get(setting, Form::Literal)?.settled_at();
        let times = settling_of(swept, setting, Form::Literal).iter();
        let late = times.filter(|(_, at)| at.is_some_and(|at| is_long(at, without)));
        let late: Vec<String> = late.map(|(limit, _)| three(Some(*limit))).collect();
        elsewhere.push((setting, late));
    }
    let here = printed.0.is_some_and(|with| is_long(with, printed.1));
    let everywhere = elsewhere.iter().all(|(_, late)| !late.is_empty());
    let verdict = Verdict::assumed(here, everywhere);
    let counts = elsewhere.iter().map(|(setting, late)| {
        let name = format!("limits tried that make a long transient, {}", setting.label());
        number(&name, "", late.len() as f64, 0.0)
    });
    let counts: Vec<_> = if whole(swept) { counts.collect() } else { Vec::new() };
    let say = |(with, without): (Option<f64>, Option<f64>)| {
        let at = |time: Option<f64>| {
            time.map_or("never".to_owned(), |t| format!("{} s", three(Some(t))))
        };
        format!("{} (without a limit: {})", at(with), at(without))
    };
    let name = |form: &str, limit: &str| format!("slowest gains settle at, {form}, {limit}");
    let mut numbers = vec![
        number(&name("printed form", "limit"), "s", printed.0, 1e-2),
        number(&name("printed form", "no limit"), "s", printed.1, 1e-2),
        number(&name("observer form", "limit"), "s", observer.0, 1e-2),
        number(&name("observer form", "no limit"), "s", observer.1, 1e-2),
    ];
    numbers.extend(counts);
    Ok(statement(
        [
            "fig9-10-transient",
            "Figs. 9, 10, Sec. VII-B",
            "Torque saturation makes the transient long; then the arm follows.",
            "drawings",
        ],
        verdict,
        (
            format!(
                "slowest gains, |e| < 0.01 rad for good from: printed form {}; observer form {}",
                say(printed),
                say(observer)
            ),
            why_long(printed.0, observer.0, &elsewhere),
        ),
        numbers,
    ))
}

fn why_long(
    printed: Option<f64>,
    observer: Option<f64>,
    elsewhere: &[(Setting, Vec<String>)],
) -> String {
    let here = match (printed, observer) {
        (None, Some(_)) => {
            "The printed form does not settle: its integrals go on while the torque is at its limit, and \
             wind up until the arm spins. The observer form, fed with the torque that acted, settles."
        }
        (None, None) => "Neither form settles under this limit.",
        (Some(_), _) => "The printed form settles under this limit.",
    };
    let late = elsewhere.iter().map(|(setting, late)| {
        let limits = if late.is_empty() { "none".to_owned() } else { late.join(", ") + " N·m" };
        format!("{}: {limits}", setting.label())
    });
    let late: Vec<String> = late.collect();
    format!(
        "{here} Limits tried at which the printed form settles, and takes {LONG} times as long as without \
         one: {}. Above them saturation hardly shows, below them there is no return. The limit of the \
         experiments is not printed.",
        late.join("; ")
    )
}

/// Whether every limit was tried: a quick sweep leaves some out, and its counts are others.
fn whole(swept: &Settling) -> bool {
    swept.iter().all(|(.., times)| times.len() == LIMITS.len())
}

/// When a setting settles, by limit.
fn settling_of(swept: &Settling, setting: Setting, form: Form) -> &[(f64, Option<f64>)] {
    let of = swept.iter().find(|(s, f, _)| (*s, *f) == (setting, form));
    of.map_or(&[], |(.., times)| times)
}

/// "Saturation can be considered as part of φ".
///
/// Where the printed form does not get to the steady part it is open: the paper reports that it did.
pub(crate) fn in_phi(
    runs: &Runs,
    free: &Runs,
    swept: &Settling,
    varied: &Varied,
) -> Result<Statement, PartError> {
    let (printed, observer) = (slowest(runs, Form::Literal)?, slowest(runs, Form::Observer)?);
    let least = |setting: Setting, form: Form| {
        let times = settling_of(swept, setting, form);
        // The smallest limit from which on it settles at every limit tried.
        let last_failure = times.iter().rposition(|(_, at)| at.is_none());
        times.get(last_failure.map_or(0, |k| k + 1)).map(|(limit, _)| *limit)
    };
    let mut numbers = Vec::new();
    let mut listed = Vec::new();
    for setting in Setting::ALL {
        let limit = least(setting, Form::Literal);
        let named = number(
            &format!("least limit from which on it settles, {}, printed form", setting.label()),
            "N·m",
            limit,
            0.0,
        );
        numbers.extend(whole(swept).then_some(named));
        listed.push(format!("{}: {} N·m", setting.label(), three(limit)));
    }
    let asked = runs_torque(free, Form::Literal)?;
    numbers.push(number("largest torque without a limit, printed form", "N·m", asked, 1e-2));
    numbers.push(number(
        "largest torque without a limit, observer form",
        "N·m",
        runs_torque(free, Form::Observer)?,
        1e-2,
    ));
    for (claim, order) in SETTLES.into_iter().zip(1..) {
        numbers.extend(varied.counts(claim, &format!("m = {order} settles")));
    }
    let why = if printed.is_none() {
        let observer = if observer.is_some() { "settles" } else { "does not settle either" };
        format!(
            "Under the assumed limit clipping keeps the printed form from acting: no estimate can make up for \
             torque that is not there, and (9), (10) do not know that it is not there; it asks for \
             {asked:.0} N·m in this start. So it is open whether it was so in the paper's experiments, which \
             report success. m = 1: {} m = 2: {} Fed with the torque that acted, τ_applied − M̄q̈, the \
             observer form {observer}.",
            varied.depends(SETTLES[0]),
            varied.depends(SETTLES[1])
        )
    } else {
        format!(
            "Under this limit the printed form recovers by itself; it asks for {asked:.0} N·m in this start."
        )
    };
    Ok(statement(
        [
            "saturation-in-phi",
            "Sec. VII-B",
            "Saturation does not spoil the steady part: it counts as part of φ, which the controller estimates.",
            "in words",
        ],
        verdict(printed.is_some(), false),
        (format!("the printed form settles from this limit on: {}", listed.join("; ")), why),
        numbers,
    ))
}

fn runs_torque(runs: &Runs, form: Form) -> Result<f64, PartError> {
    let most = |setting: &Setting| Ok(runs.get(*setting, form)?.torque_max());
    let all: Vec<f64> = Setting::ALL.iter().map(most).collect::<Result<_, PartError>>()?;
    Ok(all.into_iter().fold(0.0, f64::max))
}

pub(crate) fn limit_figure(swept: &Settling) -> Figure {
    let panel = |form: Form| {
        let of = swept.iter().filter(|(_, other, _)| *other == form);
        let series = of.map(|(setting, _, times)| {
            curve(setting.label(), times.iter().filter_map(|(limit, at)| at.map(|at| [*limit, at])))
        });
        let title = format!("{} form", form_name(form));
        lines(
            &title,
            (log_axis("torque limit [N·m]"), axis("|e| < 0.01 rad from [s]")),
            series.collect(),
            Vec::new(),
        )
    };
    let caption = "When the arm has settled, by torque limit; no point where it does not settle in two turns.";
    figure(
        "fig-torque-limit",
        "How much torque the transient needs",
        caption,
        FORMS.map(panel).into(),
    )
}
