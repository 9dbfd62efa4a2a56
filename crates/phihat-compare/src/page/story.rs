//! First part of the page: the picture, the best law for each kind of user, and the order of all laws in
//! every world.

use maud::{Markup, html};
use phihat_campaign::statistics::geometric_mean;
use phihat_report::kit::MILLI;
use phihat_report::kit::anchor;
use phihat_report::kit::number::{number, stated};
use phihat_report::kit::shade::{Shade, shades};
use phihat_report::kit::text::line;

use super::losses::is_proposed;
use super::names::{named, title};
use super::outcome::{two_digits, unrest};
use super::scatter;
use super::words::is_designed;
use crate::{ArmRecord, Comparison, GainsKind, LawCell, LawRow, SATURATION};

/// First part of the page for an arm.
pub(super) fn story(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    html! {
        (whose(comparison, arm))
        (scatter::noise(comparison, arm))
        (ranks(comparison, arm))
    }
}

/// A row's cell in a world with tuned gains, where its arm followed without noise beyond the cap and did not
/// stay at a limit.
fn quiet<'a>(comparison: &Comparison, row: &'a LawRow, world: &str) -> Option<&'a LawCell> {
    let cell = row.cell(world, GainsKind::Tuned).filter(|cell| cell.outcome.followed())?;
    unrest(comparison, cell).is_none().then_some(cell)
}

/// Worlds in which no joint is pushed beyond its torque limit.
fn worlds(comparison: &Comparison) -> impl Iterator<Item = &str> {
    comparison.worlds.iter().map(|world| world.name.as_str()).filter(|name| *name != SATURATION)
}

/// A figure of a row over all worlds without a push, as a geometric mean; `None` where it was not quiet in one of them.
fn over_worlds(
    comparison: &Comparison,
    row: &LawRow,
    of: impl Fn(&LawCell) -> Option<f64>,
) -> Option<f64> {
    let each = |world| of(quiet(comparison, row, world)?).filter(|value| *value > 0.0);
    let values = worlds(comparison).map(each).collect::<Option<Vec<f64>>>()?;
    (!values.is_empty()).then(|| geometric_mean(&values))
}

/// Root-mean-square error \[rad\] over worlds.
fn error(comparison: &Comparison, row: &LawRow) -> Option<f64> {
    over_worlds(comparison, row, |cell| Some(cell.worst.as_ref()?.error_rms_rad))
}

/// Torque noise in the world where it is worst, as a share of the torque limit; `None` where the row was not
/// quiet in one of them.
fn noise(comparison: &Comparison, row: &LawRow) -> Option<f64> {
    let each = |world| Some(quiet(comparison, row, world)?.worst.as_ref()?.noise);
    worlds(comparison).map(each).try_fold(0.0, |most: f64, noise| Some(most.max(noise?)))
}

fn needs_model(comparison: &Comparison, row: &LawRow) -> bool {
    comparison.rival(&row.rival).is_none_or(|rival| !rival.needs.model_free())
}

/// Returns true if a row satisfies its specification in every world without a push.
fn keeps(comparison: &Comparison, row: &LawRow) -> bool {
    let kept = |cell: &LawCell| cell.worst.as_ref().is_some_and(|f| f.error_over_spec <= 1.0);
    worlds(comparison).all(|world| quiet(comparison, row, world).is_some_and(kept))
}

/// Selection of rows.
type RowChoice = fn(&Comparison, &LawRow) -> bool;

/// A kind of user: what they say of themselves, which rows are for them, and what they prefer, smaller values first.
struct User {
    says: &'static str,
    may: RowChoice,
    prefers: fn(&Comparison, &LawRow) -> Option<f64>,
    /// Further rows whose best one is reported, and their name.
    also: Option<(&'static str, RowChoice)>,
}

const USERS: [User; 6] = [
    User {
        says: "You have no model of your arm, and tune by hand or by search",
        may: |all, row| !needs_model(all, row) && !is_designed(all.rival(&row.rival)),
        prefers: error,
        also: None,
    },
    User {
        says: "You have no model of your arm, and do not want to tune",
        may: |all, row| is_designed(all.rival(&row.rival)),
        prefers: error,
        also: None,
    },
    User {
        says: "You have a model of your arm, not quite right",
        may: |_, _| true,
        prefers: error,
        also: Some(("laws that use it", needs_model)),
    },
    User {
        says: "You need a bound that is stated before the arm moves",
        may: |all, row| {
            let stated = |world| {
                quiet(all, row, world)
                    .and_then(|cell| cell.worst.as_ref()?.bound_over_measured)
                    .is_some_and(|ratio| ratio >= 1.0)
            };
            worlds(all).all(stated)
        },
        prefers: error,
        also: None,
    },
    User {
        says: "You hear every encoder step: the torque has to be quiet, and the specification kept",
        may: keeps,
        prefers: noise,
        also: None,
    },
    User {
        says: "Your processor is small",
        may: keeps,
        prefers: |_, row| row.cost.as_ref()?.instructions.map(|count| count as f64),
        also: None,
    },
];

/// One sentence for each kind of user.
fn whose(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let chosen: Vec<_> = USERS.iter().map(|user| (user, best(comparison, arm, user))).collect();
    html! {
        h3 { "Which row for whom" }
        p.hint {
            "Of laws that followed in every world but “" (SATURATION) "”, without noise beyond the cap: geometric \
                means over these worlds, "
            "gains tuned; the noise is that of the worst world."
            @if let Some(apart) = scatter_of_tuning(comparison, arm) {
                " One tuning of one seed: the disturbance observer and the proposed law of m = 1 are one law under two \
                    names, and their errors came out up to "
                (two_digits(apart)) " times apart. Nearer than that, this page tells no two laws apart."
            }
        }
        ul.users { @for (user, best) in chosen { li {
            strong { (user.says) ": " }
            @match best {
                None => "no law of this comparison is for you.",
                Some((row, rows)) => {
                    (told(comparison, row)) (ours(comparison, row, &rows)) (also(comparison, user, &rows))
                }
            }
        } } }
    }
}

/// One law under two names.
const SAME: [&str; 2] = ["disturbance-observer", "proposed-1"];

/// By how many times the errors of one law under two names differ at most, world by world.
fn scatter_of_tuning(comparison: &Comparison, arm: &ArmRecord) -> Option<f64> {
    let row = |id: &str| comparison.rows_of(&arm.name).find(|row| row.rival == id);
    let [a, b] = SAME.map(row);
    let (a, b) = (a?, b?);
    let error = |row, world| Some(quiet(comparison, row, world)?.worst.as_ref()?.error_rms_rad);
    let ratios = worlds(comparison).filter_map(|world| Some(error(a, world)? / error(b, world)?));
    ratios.map(|ratio| ratio.max(1.0 / ratio)).reduce(f64::max)
}

/// The best of the rows that a user asks for by name.
fn also(comparison: &Comparison, user: &User, rows: &[&LawRow]) -> Markup {
    let Some((called, of)) = user.also else { return html! {} };
    let found = rows.iter().find(|row| of(comparison, row));
    html! { @match found {
        Some(row) => { " Of " (called) ": " (told(comparison, row)) }
        None => { " None of " (called) " followed quietly." }
    } }
}

/// The best row for a user, and all that are for them, best first.
fn best<'a>(
    comparison: &'a Comparison,
    arm: &'a ArmRecord,
    user: &User,
) -> Option<(&'a LawRow, Vec<&'a LawRow>)> {
    let value = |row: &&LawRow| {
        ((user.may)(comparison, row)).then(|| (user.prefers)(comparison, row)).flatten()
    };
    let rows = comparison.rows_of(&arm.name).filter(|row| row.refused.is_none());
    let mut rows: Vec<(f64, &LawRow)> = rows.filter_map(|row| Some((value(&row)?, row))).collect();
    rows.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let rows: Vec<&LawRow> = rows.into_iter().map(|(_, row)| row).collect();
    Some((*rows.first()?, rows))
}

/// `Name, 0.123 mrad at 0.04 % noise`.
fn told(comparison: &Comparison, row: &LawRow) -> Markup {
    let percent = |value: f64| number(100.0 * value);
    html! {
        a href=(format!("#{}", anchor("rival", &row.rival))) { (title(comparison, &row.rival)) }
        @if let Some(rival) = comparison.rival(&row.rival).filter(|rival| !rival.needs.model_free()) {
            " (needs " (line(&rival.needs_words)) ")"
        }
        @if let Some(error) = error(comparison, row) { ", " (number(MILLI * error)) " mrad rms" }
        @if let Some(noise) = noise(comparison, row) { " at " (percent(noise)) " % torque noise at most" }
        @if let Some(count) = row.cost.as_ref().and_then(|cost| cost.instructions) {
            ", " (stated(count as f64)) " instructions"
        }
        "."
    }
}

/// The best of the proposed laws for the same user, where it is not the best of all.
fn ours(comparison: &Comparison, best: &LawRow, rows: &[&LawRow]) -> Markup {
    let own = rows.iter().position(|row| is_proposed(&row.rival));
    html! { @match own {
        _ if is_proposed(&best.rival) => {}
        Some(place) => @if let Some(row) = rows.get(place) {
            " Of the proposed laws, place " (place + 1) " of " (rows.len()) ": " (told(comparison, row))
        },
        None => " None of the proposed laws is for you.",
    } }
}

/// Place of the best and of the worst of the proposed laws by its error over the worlds, among all that followed.
pub(super) fn place_of_ours(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let rows = comparison.rows_of(&arm.name).filter(|row| row.refused.is_none());
    let mut rows: Vec<(f64, &LawRow)> =
        rows.filter_map(|row| Some((error(comparison, row)?, row))).collect();
    rows.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let own: Vec<(usize, &LawRow)> = (1..)
        .zip(rows.iter().map(|(_, row)| *row))
        .filter(|(_, row)| is_proposed(&row.rival))
        .collect();
    let (Some((best, first)), Some((worst, last))) = (own.first(), own.last()) else {
        return html! {};
    };
    html! {
        " By error over these worlds, the best of the proposed laws \
            is " strong { "place " (best) " of " (rows.len()) } " ("
        (short_name(comparison, first)) ")"
        @if worst != best { ", the worst " strong { "place " (worst) } " (" (short_name(comparison, last)) ")" }
        "."
    }
}

/// A law's name without whose it is.
fn short_name(comparison: &Comparison, row: &LawRow) -> String {
    title(comparison, &row.rival).replace(" (this project)", "")
}

/// Place of a row in a world by its error, from 1, among rows that followed quietly.
fn places<'a>(
    comparison: &'a Comparison,
    arm: &'a ArmRecord,
    world: &str,
) -> Vec<(&'a str, usize)> {
    let error = |row: &LawRow| Some(quiet(comparison, row, world)?.worst.as_ref()?.error_rms_rad);
    let rows = comparison.rows_of(&arm.name);
    let mut rows: Vec<_> = rows.filter_map(|row| Some((error(row)?, row.rival.as_str()))).collect();
    rows.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    rows.into_iter().enumerate().map(|(k, (_, id))| (id, k + 1)).collect()
}

/// Shades of places by their share of all: the first ones dark.
const KEY: [(Shade, &str); 5] = [
    (Shade::Step(3), "first tenth"),
    (Shade::Step(2), "first quarter"),
    (Shade::Step(1), "first half"),
    (Shade::Step(0), "behind"),
    (Shade::None, "– did not follow, or too noisy"),
];

/// Every law's place in every world.
fn ranks(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let names: Vec<&str> = comparison.worlds.iter().map(|world| world.name.as_str()).collect();
    let worlds: Vec<_> = names.iter().map(|world| places(comparison, arm, world)).collect();
    let place = |id: &str, of: &[(&str, usize)]| of.iter().find(|(o, _)| *o == id).map(|p| p.1);
    let all = comparison.rows_of(&arm.name).filter(|row| row.refused.is_none());
    let mut rows: Vec<(f64, &LawRow, Vec<Option<usize>>)> = all
        .map(|row| {
            let own: Vec<_> = worlds.iter().map(|of| place(&row.rival, of)).collect();
            let last = |of: &Vec<(&str, usize)>| (of.len() + 1) as f64;
            let sum = own.iter().zip(&worlds).map(|(own, of)| own.map_or(last(of), |k| k as f64));
            (sum.sum::<f64>() / worlds.len().max(1) as f64, row, own)
        })
        .collect();
    rows.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
    let label = format!("Table: places on {}", line(&arm.name));
    html! {
        h3 { "Places by error, world by world" }
        p.key {
            (shades(&KEY))
            " Sorted by the mean place; ● a proposed law."
        }
        details.behind { summary { "Places of " (rows.len()) " laws in " (names.len()) " worlds" }
        div.scroll.tall tabindex="0" role="region" aria-label=(label) { table.ranks {
            thead { tr {
                th scope="col" { "law" } th scope="col" { "mean" }
                @for world in &names { th scope="col" { (line(world)) } }
            } }
            tbody { @for (mean, row, own) in &rows { tr {
                th scope="row" { @if is_proposed(&row.rival) { "● " } (named(comparison, row)) }
                td { (stated((10.0 * mean).round() / 10.0)) }
                @for (own, of) in own.iter().zip(&worlds) { (cell(*own, of.len())) }
            } } }
        } } }
    }
}

fn cell(place: Option<usize>, all: usize) -> Markup {
    let Some(place) = place else { return html! { td.q-none { "–" } } };
    // Of those that are not behind it: more is better.
    let ahead = 1.0 - (place - 1) as f64 / all.max(1) as f64;
    html! { td class=(Shade::of(ahead, [0.5, 0.75, 0.9]).class()) title=(format!("place {place} of \
    {all}")) { (place) } }
}
