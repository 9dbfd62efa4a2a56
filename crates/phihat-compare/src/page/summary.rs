//! The top of the page: what was compared, and when to pick another row.

use crate::{Comparison, GainsKind, LawCell, LawRow};
use maud::{Markup, html};

use super::losses::{Beaten, LossOfLaw, losses, proposed};
use super::names::{main_world, title};
use crate::SATURATION;
use phihat_report::kit::anchor;
use phihat_report::kit::number::{number, stated};
use phihat_report::kit::text::line;

pub(super) fn heading(comparison: &Comparison, page: &str) -> Markup {
    let runs: usize = comparison.rows.iter().flat_map(|r| &r.cells).map(|c| c.runs.len()).sum();
    let refused = comparison.rows.iter().filter(|row| row.refused.is_some()).count();
    html! { header {
        h1 { (page) }
        p.byline {
            "phihat " (line(&comparison.phihat_version)) " · " (comparison.rivals.len()) " laws · "
            (comparison.worlds.len()) " worlds · " (runs) " runs · simulated"
        }
        div.verdict {
            p {
                "Every law is tuned by the same optimiser with the same number of runs, on motions that it is not \
                    scored "
                "on, and then meets every world. No law is declared the winner: each column has its own best row."
            }
            ul {
                @for arm in &comparison.arms { li { (tally(comparison, &arm.name))
                    (super::story::place_of_ours(comparison, arm)) } }
                @if refused > 0 { li {
                    (refused) " of " (comparison.rows.len())
                    " rows have no figures, because the law does not apply to the arm or its task; each says why."
                } }
            }
            @if let Some(text) = at_ends(comparison) { p.hint { (text) } }
            p.hint {
                a href="#another-row" { "When to pick another row" } " · "
                @for arm in &comparison.arms { a href=(format!("#{}", anchor("arm", &arm.name))) { (line(&arm.name)) }
                    " · " }
                a href="#traces" { "traces" } " · " a href="#cards" { "the laws" } " · "
                a href="#terms" { "terms" } " · " a href="#not-claimed" { "not claimed" }
            }
        }
    } }
}

/// Rows with tuned scalars at an end of their range: another range might give them less error.
fn at_ends(comparison: &Comparison) -> Option<String> {
    let of = |row: &LawRow| {
        let ends = &row.tuning.as_ref()?.at_end;
        let names: Vec<_> = ends.iter().map(|end| line(&end.scalar)).collect();
        (!ends.is_empty()).then(|| {
            format!(
                "{} on {} ({})",
                title(comparison, &row.rival),
                line(&row.arm),
                names.join(", ")
            )
        })
    };
    let rows: Vec<_> = comparison.rows.iter().filter_map(of).collect();
    (!rows.is_empty()).then(|| {
        format!("Tuned scalars at an end of their range, widened or not: {}.", rows.join("; "))
    })
}

/// Numbers of laws that follow in every world, and that satisfy the specification.
fn tally(comparison: &Comparison, arm: &str) -> Markup {
    let rows: Vec<_> = comparison.rows_of(arm).filter(|row| row.refused.is_none()).collect();
    let all = comparison.worlds.len();
    let everywhere = rows.iter().filter(|row| super::quantity::worlds_followed(row) == all).count();
    let kept = |cell: &&LawCell| {
        cell.gains == GainsKind::Tuned
            && cell.outcome.followed()
            && cell.worst.as_ref().is_some_and(|f| f.error_over_spec <= 1.0)
    };
    let keeps = |row: &LawRow, pushed: bool| {
        row.cells.iter().filter(kept).filter(|cell| (cell.world == SATURATION) == pushed).count()
    };
    let pushed = comparison.worlds.iter().filter(|world| world.name == SATURATION).count();
    let quiet = all - pushed;
    let spec = rows.iter().filter(|row| keeps(row, false) == quiet).count();
    let under_push = rows.iter().filter(|row| keeps(row, true) == pushed).count();
    html! {
        strong { (line(arm)) } ": " (everywhere) " of " (rows.len()) " laws follow in all " (all) " worlds with tuned \
            gains"
        @if quiet > 0 {
            "; " (spec) " keep the specification in "
            @if pushed > 0 { "the " (quiet) " worlds without a push" } @else { "all of them" }
        }
        "."
        @if pushed > 0 {
            " In “" (SATURATION) "”, where every joint is pushed with more than its torque \
                limit, " (under_push) " keep it."
        }
    }
}

/// Columns in which the proposed law is not the best row, in the order of the table.
pub(super) fn another_row(comparison: &Comparison) -> Markup {
    let losses = losses(comparison);
    let world = main_world(comparison).map(line).unwrap_or_default();
    html! {
        h2 id="another-row" { "When to pick another row" }
        p {
            "The program that made this page is built around the proposed law. Below is every column in which some "
            "other row is better by more than 2 %, over all worlds, gains tuned; the tables have the same figures "
            "for “" (world) "”."
        }
        @for id in proposed(comparison) {
            (against(comparison, id, &losses))
        }
        @if proposed(comparison).next().is_none() {
            p { "The proposed law was not among the laws of this comparison." }
        }
    }
}

fn against(comparison: &Comparison, id: &str, losses: &[LossOfLaw]) -> Markup {
    let of: Vec<_> = losses.iter().filter(|loss| loss.ours == id).collect();
    let ran = comparison.rows.iter().any(|row| row.rival == id && row.refused.is_none());
    html! {
        h3 { "Instead of " (title(comparison, id)) }
        @if !ran {
            p { "It was not run on any arm: there is nothing to compare." }
        } @else if of.is_empty() {
            p.no-losses { "In these runs no other row is better in any column." }
        } @else {
            ul.losses { @for loss in of { li {
                strong { "If what matters most is " (loss.counts) } " (" (loss.column) "): another row is better in "
                (loss.cases) " of " (loss.compared) " cases. " (beaten(comparison, loss, &loss.most))
                @match &loss.model_free {
                    None => { " No row without a model of the arm is better." }
                    Some(same) if *same == loss.most => {}
                    Some(other) => { " Without a model of the arm: " (beaten(comparison, loss, other)) }
                }
            } } }
        }
    }
}

/// `5 %` or `3.2 times`.
fn by_how_much(factor: f64) -> String {
    if factor < 1.5 {
        return format!("{} %", stated((100.0 * (factor - 1.0)).round()));
    }
    format!("{} times", stated(format!("{factor:.2e}").parse().unwrap_or(factor)))
}

/// One case in words.
fn beaten(comparison: &Comparison, loss: &LossOfLaw, case: &Beaten) -> Markup {
    let unit = if loss.unit.is_empty() { String::new() } else { format!(" {}", loss.unit) };
    let by = comparison.rival(&case.by);
    html! {
        a href=(format!("#{}", anchor("rival", &case.by))) { (title(comparison, &case.by)) }
        @if let Some(rival) = by.filter(|rival| !rival.needs.model_free()) {
            " (needs " (line(&rival.needs_words)) ")"
        }
        " on " (line(&case.arm))
        @if let Some(world) = &case.world { " in “" (line(world)) "”" }
        ": " (number(case.theirs)) (unit)
        @match case.mine {
            Some(mine) => {
                " against " (number(mine)) (unit)
                @if case.factor().is_finite() { ", " (by_how_much(case.factor())) }
                "."
            }
            None if case.world.is_none() => ", and no run of this row's own tuning did.",
            None => ", where this row has nothing to compare: its arm did not follow, or it states no bound that held."
        }
    }
}
