//! Effect of a torque limit on the transient, and the start distance from the path at which it does no harm.

use super::run::Run;
use super::runs::{Runs, form_name};
use super::start_map::{CLASSES, Cell, LONG, Mapped, NEAREST_M, StartMap, StartOutcome, nearer};
use super::studies::{GainSetting, Studies};
use super::transient::SHOWN_S;
use crate::compose::{axis, axis_over, curve, figure, lines, log_axis, number, statement, three};
use crate::item::{Item, Kind};
use crate::part::PartError;
use crate::record::{PaperNumber, Statement, Verdict};
use phihat::Form;
use phihat_report::kit::figure::{Content, Figure, Panel};

/// Runs that settled and kept their bounds.
const GOOD: [StartOutcome; 2] = [StartOutcome::Soon, StartOutcome::Late];

/// Variations of the start and the limit, in words.
fn varied(map: &StartMap) -> String {
    let rows = map.maps.first().map_or(&[][..], |map| &map.rows);
    let cells = rows.first().map_or(&[][..], |row| &row.cells);
    let listed = |all: &mut dyn Iterator<Item = f64>| -> String {
        all.map(|value| three(Some(value))).collect::<Vec<_>>().join(", ")
    };
    format!(
        "Start {} m from the path and limits of {} N·m, each with each (the map); the path is moved as a whole, the \
            start stays as printed.",
        listed(&mut rows.iter().map(|row| row.distance)),
        listed(&mut cells.iter().map(|cell| cell.limit))
    )
}

/// Farthest start from which the printed form settles under the limit of the studies, and the limit that it
/// needs from their start, in words.
pub(crate) fn turning(map: &StartMap, settings: &[GainSetting]) -> String {
    let (limit, far) = map.assumed;
    let of = |map: &Mapped| {
        let edge = map.edge.map_or_else(
            || format!("from no start, down to {NEAREST_M} m"),
            |edge| format!("from starts up to {} m", three(Some(edge))),
        );
        let enough = map
            .enough(far)
            .map_or("no limit tried".to_owned(), |limit| format!("{} N·m", three(Some(limit))));
        format!("{}: {edge}, or from {enough} on", map.setting.label())
    };
    let each: Vec<String> =
        settings.iter().filter_map(|setting| map.printed(*setting)).map(of).collect();
    format!(
        "The printed form settles and keeps its bounds with {} N·m, or from {} m: {}.",
        three(Some(limit)),
        three(Some(far)),
        each.join("; ")
    )
}

/// The thresholds of [`turning`] as numbers.
pub(crate) fn thresholds(map: &StartMap, settings: &[GainSetting]) -> Vec<PaperNumber> {
    let (limit, far) = map.assumed;
    let of = |of: &Mapped| {
        let label = of.setting.label();
        let edge = format!("farthest start under {} N·m, {label}", three(Some(limit)));
        let enough = format!("least limit from {} m, {label}", three(Some(far)));
        let enough = number(&enough, "N·m", of.enough(far), 0.0);
        [Some(number(&edge, "m", of.edge, 0.1)), map.whole.then_some(enough)]
    };
    let maps = settings.iter().filter_map(|setting| map.printed(*setting));
    maps.flat_map(of).flatten().collect()
}

/// Nearest start from which the limit of the studies makes the transient of a setting long: its distance \[m\], and
/// the settling times with the limit and without \[s\].
fn longest(map: &StartMap, setting: GainSetting) -> Option<(f64, f64, f64)> {
    let late = map.printed(setting)?.rows.iter().filter_map(|row| {
        let at_limit = |cell: &&Cell| {
            cell.limit.total_cmp(&map.assumed.0).is_eq() && cell.outcome == StartOutcome::Late
        };
        let cell = row.cells.iter().find(at_limit)?;
        Some((row.distance, cell.at?, row.free?))
    });
    // The nearest start at which it shows.
    late.reduce(|first, _| first)
}

/// Joint 2 of m = 1 as printed, from the nearest start at which the limit makes the transient long; `None`: there
/// is no such start.
pub(crate) fn near_figure(studies: &Studies, map: &StartMap) -> Result<Option<Figure>, PartError> {
    let Some((distance, ..)) = longest(map, GainSetting::First) else { return Ok(None) };
    let [with, without] = nearer(studies, distance)?;
    let error = |label: &str, run: &Run| {
        let points = run.times().zip(&run.joints()[1].e).map(|(t, e)| [t, *e]);
        curve(label, points.take_while(|[t, _]| *t <= SHOWN_S))
    };
    let series = vec![error("with the limit", &with), error("without", &without)];
    let axes = (axis_over("t [s]", 0.0, SHOWN_S), axis("e of joint 2 [rad]"));
    let panel = lines("m = 1, printed form", axes, series, Vec::new());
    let caption = format!(
        "The printed form from {} m beside the path in place of {} m, as far as nothing else is changed: it saturates, \
         takes longer, and follows, as the paper's Fig. 9.",
        three(Some(distance)),
        three(Some(map.assumed.1))
    );
    let title = "Fig. 9 from a nearer start";
    Ok(Some(figure("fig-09-near", title, &caption, vec![panel])))
}

/// "The long transient is because of the torque saturation".
pub(crate) fn long_transient(map: &StartMap, settings: &[GainSetting]) -> Statement {
    let order = if settings == [GainSetting::First] { 1 } else { 2 };
    let limit = three(Some(map.assumed.0));
    let each = settings.iter().map(|setting| {
        let label = setting.label();
        match longest(map, *setting) {
            Some((distance, at, free)) => {
                let times = [distance, at, free].map(|value| three(Some(value)));
                format!(
                    "{label}: from {} m settled after {} s, {} s without the limit",
                    times[0], times[1], times[2]
                )
            }
            None => format!("{label}: from none of the starts"),
        }
    });
    let each: Vec<String> = each.collect();
    let holds = map.somewhere(settings, &[StartOutcome::Late]);
    let mut numbers = Vec::new();
    for setting in settings {
        let found = longest(map, *setting);
        let name = |what: &str| format!("{what}, {}", setting.label());
        // A quick map has fewer starts, and another nearest one.
        if map.whole {
            numbers.push(number(&name("start"), "m", found.map(|found| found.0), 1e-2));
            numbers.push(number(&name("settled"), "s", found.map(|found| found.1), 2e-2));
            numbers.push(number(
                &name("the same without the limit"),
                "s",
                found.map(|found| found.2),
                2e-2,
            ));
        }
    }
    let why = if holds {
        "Whether it is so hangs on how far from the path the arm starts: nearer, the limit hardly shows; farther, the \
         printed form's integrals wind up and there is no return. Neither distance nor limit is printed, and between \
         the two lies what the paper reports."
    } else {
        "Under this limit the printed form either winds up or hardly notices, but for larger limits or nearer starts \
         (the map): with what is not printed it may have been as the paper reports."
    };
    statement(
        [
            &format!("fig9-10-long-m{order}"),
            "Figs. 9, 10, Sec. VII-B",
            &format!("With m = {order} torque saturation makes the transient long; then the arm follows and keeps its \
                bounds."),
            "drawings",
        ],
        Verdict::assumed(holds, false),
        (format!("{limit} N·m: {}", each.join("; ")), why.to_owned()),
        numbers,
    )
    .read_as(format!(
        "Long: {LONG} times as long as without the limit, or longer, and ({}) kept on the second turn. It counts as \
         printed where every gain set does so in the printed form with the assumed limit from one of the starts.",
        47 + order
    ))
    .varying(varied(map))
    .turning(turning(map, settings))
    .covering(&[Item { kind: Kind::Figure, number: 9 }, Item { kind: Kind::Figure, number: 10 }])
}

/// "Saturation can be considered as part of φ".
pub(crate) fn in_phi(free: &Runs, map: &StartMap) -> Result<Statement, PartError> {
    let (printed, cells) = map.count(Form::Literal, &GOOD);
    let (observer, few) = map.count(Form::Observer, &GOOD);
    let (asked, ours) = (runs_torque(free, Form::Literal)?, runs_torque(free, Form::Observer)?);
    let mut numbers = vec![
        number("largest torque without a limit, printed form", "N·m", asked, 1e-2),
        number("largest torque without a limit, observer form", "N·m", ours, 1e-2),
    ];
    if map.whole {
        numbers.push(number(
            "places of the map at which the printed form is not spoiled",
            "",
            printed as f64,
            0.0,
        ));
        numbers.push(number("places that were tried", "", cells as f64, 0.0));
    }
    numbers.push(number(
        "places at which the observer form is not spoiled",
        "",
        observer as f64,
        0.0,
    ));
    numbers.extend(thresholds(map, &GainSetting::ALL));
    Ok(statement(
        [
            "saturation-in-phi",
            "Sec. VII-B",
            "Saturation does not spoil the steady part: it counts as part of φ, which the controller estimates.",
            "in words",
        ],
        Verdict::of(printed == cells, observer == few),
        (
            format!("steady part as without the limit: printed form at {printed} of {cells} places of the map, \
                observer form at {observer} of {few}"),
            format!(
                "Torque that is not there cannot be made up for, and (9), (10) do not know that it is not there: they \
                 go on summing the error, and ask for up to {asked:.0} N·m in the start of the studies. Fed with the \
                 torque that acted, τ_applied − M̄q̈, the estimator takes the limit for a part of φ, as the paper \
                 says. The printed form does where the arm starts near enough, which its experiments may have done."
            ),
        ),
        numbers,
    )
    .read_as(
        "As a general statement, over all starts and limits tried: the arm settles, and keeps those bounds of (48), \
            (49) that it keeps without a limit.",
    )
    .varying(format!("{} Observer form: at a few of them.", varied(map)))
    .turning(turning(map, &GainSetting::ALL)))
}

fn runs_torque(runs: &Runs, form: Form) -> Result<f64, PartError> {
    let most = |setting: &GainSetting| Ok(runs.get(*setting, form)?.torque_max());
    let all: Vec<f64> = GainSetting::ALL.iter().map(most).collect::<Result<_, PartError>>()?;
    Ok(all.into_iter().fold(0.0, f64::max))
}

/// The map of every setting in the printed form.
pub(crate) fn map_figure(map: &StartMap) -> Figure {
    let panel = |map: &Mapped| {
        let cells = map.rows.iter().map(|row| {
            let class = |cell: &Cell| match cell.outcome {
                StartOutcome::Lost => 0,
                StartOutcome::Spoiled => 1,
                StartOutcome::Soon => 2,
                StartOutcome::Late => 3,
            };
            row.cells.iter().map(class).collect()
        });
        let first = map.rows.first().map_or(&[][..], |row| &row.cells);
        Panel {
            title: format!("{}, {} form", map.setting.label(), form_name(map.form)),
            x: log_axis("torque limit [N·m]"),
            y: log_axis("start, from the path [m]"),
            content: Content::Map {
                x: first.iter().map(|cell| cell.limit).collect(),
                y: map.rows.iter().map(|row| row.distance).collect(),
                cells: cells.collect(),
                classes: CLASSES.map(str::to_owned).into(),
            },
            ..Panel::default()
        }
    };
    let caption = "What the paper reports lies between a limit that does not show and one from which the printed form \
                   does not return. The studies of Figs. 9 to 11 lie in the top row.";
    let printed = map.maps.iter().filter(|map| map.form == Form::Literal);
    figure(
        "fig-saturation-map",
        "Start distance and torque limit together",
        caption,
        printed.map(panel).collect(),
    )
}
