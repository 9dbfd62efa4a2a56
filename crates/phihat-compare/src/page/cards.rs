//! A card per law: what it is, where it is from, what it needs, which gains it ran with, why each mark is as it is.

use crate::{Comparison, LawRow, RivalRecord, ScalarRecord, TuningRecord};
use maud::{Markup, html};
use phihat_rivals::WITHOUT_ROW;

use super::names::title;
use super::ticks::{COLUMNS, beside, measured, symbol};
use super::words::{DEFAULTS, NOT_TUNED, UNITS, model_free_in_full};
use phihat_report::kit::anchor;
use phihat_report::kit::number::{number, stated};
use phihat_report::kit::text::{line, visible};

pub(super) fn cards(comparison: &Comparison) -> Markup {
    html! {
        h2 id="cards" { "The laws" }
        p {
            "Grade A: textbook, or confirmed in a public source or code. B: the structure is confirmed, details are \
                reconstructed. C: the published law was "
            "not found, and a well-documented law of its class stands for it. None of these is its authors' program."
        }
        p { "Scalars: " (UNITS) ". Default gains: " (DEFAULTS) "." }
        @for rival in &comparison.rivals { (card(comparison, rival)) }
        h3 { "Cited by the paper, without a row" }
        dl { @for cited in WITHOUT_ROW {
            dt { (cited.reference) " " (cited.source) }
            dd { (cited.subject) ": " (cited.reason) "." }
        } }
    }
}

fn card(comparison: &Comparison, rival: &RivalRecord) -> Markup {
    let rows: Vec<_> = comparison.rows.iter().filter(|row| row.rival == rival.id).collect();
    html! { section.rival id=(anchor("rival", &rival.id)) {
        h3 { (title(comparison, &rival.id)) " " span.unit { (line(&rival.id)) } }
        pre.law tabindex="0" { (visible(&rival.law)) }
        dl {
            dt { "source" }
            dd { (line(&rival.source)) @if !rival.reference.is_empty() { " (the \
                paper's " (line(&rival.reference)) ")" } }
            dt { "grade" }
            dd { (line(&rival.grade)) @if !rival.caveat.is_empty() { ": " (line(&rival.caveat)) } }
            dt { "is handed" }
            dd { (line(&rival.needs_words)) " (" (model_free_in_full(rival)) ")" }
            @for row in &rows { @if let Some(why) = &row.refused {
                dt { "on " (line(&row.arm)) }
                dd { "does not apply: " (line(why)) }
            } }
        }
        (gains(rival, &rows))
        @if rows.iter().any(|row| row.columns.is_some()) {
            details { summary { "Marks and why" } @for row in &rows { (marks(row)) } }
        }
    } }
}

fn gains(rival: &RivalRecord, rows: &[&LawRow]) -> Markup {
    if rival.scalars.is_empty() {
        return html! { p.hint { "Gains: " (NOT_TUNED) "." } };
    }
    let label = format!("Table: gains of {}", line(&rival.title));
    let tuned = || rows.iter().filter_map(|row| row.tuning.as_ref().map(|t| (row, t)));
    html! {
        div.scroll tabindex="0" role="region" aria-label=(label) { table.gains {
            thead { tr {
                th scope="col" { "scalar" }
                th scope="col" { "unit" }
                th scope="col" { "range" }
                th scope="col" { "default" }
                @for (row, _) in tuned() { th scope="col" { "tuned, " (line(&row.arm)) } }
            } }
            tbody { @for (i, scalar) in rival.scalars.iter().enumerate() { tr {
                th scope="row" { (line(&scalar.name)) span.note { (line(&scalar.meaning)) } }
                td { (line(&scalar.unit)) }
                td { (stated(scalar.range[0])) " … " (stated(scalar.range[1])) }
                td { (stated(scalar.default)) }
                @for (_, tuning) in tuned() {
                    td {
                        (tuning.tuned.get(i).map_or_else(|| "–".to_owned(), |v| number(*v)))
                        @if let Some(where_) = end(tuning, scalar) { span.note { (where_) } }
                    }
                }
            } } }
        } }
        p.hint { "One value for all joints; a gain on torque is times U of the joint, or times what the law is \
            handed." }
        @for (row, tuning) in tuned() { p.hint {
            (line(&row.arm)) ": " (tuning.runs) " runs took the cost from " (number(tuning.cost_default)) " to "
            (number(tuning.cost_tuned)) "; "
            @if tuning.rounds > 1 { (widened(tuning, rival)) }
            @match tuning.runs_to_spec {
                Some(run) => { "run " (run) " was the first to keep the specification." }
                None => "none kept the specification.",
            }
        } }
    }
}

/// At which end of its range a tuned value is left, if it is.
fn end(tuning: &TuningRecord, scalar: &ScalarRecord) -> Option<&'static str> {
    let end = tuning.at_end.iter().find(|end| end.scalar == scalar.name)?;
    Some(if end.upper { "at the upper end of its range" } else { "at the lower end of its range" })
}

/// Returns true if `range` reaches beyond `of`.
fn wider(of: [f64; 2], range: [f64; 2]) -> bool {
    range[0] < of[0] || range[1] > of[1]
}

/// Ranges that were widened, and their new ends.
fn widened(tuning: &TuningRecord, rival: &RivalRecord) -> String {
    let wider = rival
        .scalars
        .iter()
        .zip(&tuning.ranges)
        .filter(|(scalar, range)| wider(scalar.range, **range));
    let each = wider.map(|(scalar, [low, high])| {
        format!("{} to {} … {}", line(&scalar.name), stated(*low), stated(*high))
    });
    format!(
        "in {} rounds, ranges widened: {}; ",
        tuning.rounds,
        each.collect::<Vec<_>>().join(", ")
    )
}

fn marks(row: &LawRow) -> Markup {
    let Some(columns) = &row.columns else { return html! {} };
    html! {
        p { strong { (line(&row.arm)) } }
        dl {
            @for (name, measured) in COLUMNS.iter().zip(measured(columns)) {
                dt { (name) }
                dd { strong { (symbol(measured.mark)) } " (" (beside(measured)) "): " (line(&measured.why)) }
            }
            @if let Some(condition) = &columns.condition {
                dt { "its own condition" }
                dd {
                    (line(&condition.text)) ": " @if condition.holds { "holds" } @else { "does not hold" }
                    @if let Some(margin) = condition.margin { ", left over right " (number(margin)) }
                }
            }
        }
    }
}
