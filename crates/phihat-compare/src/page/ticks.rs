//! The paper's table beside the measured one: printed tick, measured tick, agree or disagree.

use crate::{ArmRecord, Comparison, LawRow, Mark, MarkColumns, MeasuredTicks};
use maud::{Markup, html};

use super::names::named;
use phihat_report::kit::anchor;
use phihat_report::kit::text::line;

/// The paper's columns, in its order.
pub(super) const COLUMNS: [&str; 4] =
    ["quantitative performance", "easy tuning", "optimal", "model free"];

/// The measured columns, in the same order.
pub(super) fn measured(columns: &MarkColumns) -> [&MeasuredTicks; 4] {
    [&columns.quantitative, &columns.easy, &columns.optimal, &columns.model_free]
}

pub(super) fn table(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let all = || comparison.rows_of(&arm.name).filter_map(|row| row.columns.as_ref());
    let marks = || all().flat_map(measured).filter_map(|measured| measured.agrees);
    let (agree, compared) = (marks().filter(|agrees| *agrees).count(), marks().count());
    html! {
        h3 { "The paper's columns, measured" }
        p {
            "Measured here, and beside it what the paper prints. " (agree) " of " (compared)
            " printed marks agree. Why each is as it is stands with the law."
        }
        div.scroll tabindex="0" role="region" aria-label=(format!("Table: the paper's columns on \
            {}", line(&arm.name))) {
            table.sortable.ticks {
                thead { tr {
                    th scope="col" { "law" }
                    @for column in COLUMNS { th scope="col" { (column) } }
                } }
                tbody { @for (place, row) in comparison.rows_of(&arm.name).enumerate() { tr {
                    th scope="row" data-v=(place) { (named(comparison, row)) }
                    (marks_of(row))
                } } }
            }
        }
    }
}

fn marks_of(row: &LawRow) -> Markup {
    let Some(columns) = &row.columns else {
        return html! { @for _ in COLUMNS { td { "–" span.note { "not run" } } } };
    };
    html! { @for measured in measured(columns) {
        td.disagrees[measured.agrees == Some(false)] data-v=(key(measured.mark)) {
            a href=(format!("#{}", anchor("rival", &row.rival))) { (symbol(measured.mark)) }
            span.note { (beside(measured)) }
        }
    } }
}

fn key(mark: Mark) -> u8 {
    match mark {
        Mark::Yes => 0,
        Mark::Partly => 1,
        Mark::No => 2,
    }
}

/// A mark, readable without its symbol.
pub(super) fn symbol(mark: Mark) -> &'static str {
    match mark {
        Mark::Yes => "✓ yes",
        Mark::No => "✗ no",
        Mark::Partly => "– partly",
    }
}

/// Mark that the paper prints, and its agreement with the measured one.
pub(super) fn beside(measured: &MeasuredTicks) -> String {
    match (measured.printed, measured.agrees) {
        (Some(printed), Some(true)) => format!("printed {}: agrees", symbol(printed)),
        (Some(printed), Some(false)) => format!("printed {}: DISAGREES", symbol(printed)),
        (Some(printed), None) => format!("printed {}", symbol(printed)),
        (None, _) => "nothing printed".to_owned(),
    }
}
