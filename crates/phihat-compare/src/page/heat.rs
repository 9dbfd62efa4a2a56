//! The robustness map of an arm: law by world, a symbol and a number in every cell.

use crate::{ArmRecord, Comparison, GainsKind, LawCell, LawRow};
use maud::{Markup, html};

use super::names::named;
use super::outcome::{outcome_in_full, symbol_and_word, two_digits, unrest};
use super::words::is_designed;
use phihat_report::kit::anchor;
use phihat_report::kit::shade::{Shade, shades};
use phihat_report::kit::text::line;

/// Largest error over the specification up to which a cell has each of the first shades.
const LEVELS: [f64; 3] = [1.0, 3.0, 10.0];

const KEY: [(Shade, &str); 8] = [
    (Shade::Step(0), "✓ up to 1: kept"),
    (Shade::Step(1), "to 3"),
    (Shade::Step(2), "to 10"),
    (Shade::Step(3), "beyond"),
    (Shade::Beyond, "▲ did not follow"),
    (Shade::Broken, "✗ diverged"),
    (Shade::Broken, "⊘ not a number"),
    (Shade::None, "– does not apply"),
];

pub(super) fn map(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    html! {
        h3 { "Robustness" }
        p.key {
            "Largest |e| over the specification's, worst of all motions and joints: "
            (shades(&KEY))
            span { "≈ it followed, with torque noise beyond the cap of the tuning or at its torque limits" }
            " Large: tuned gains. Small: the default ones."
        }
        div.scroll tabindex="0" role="region" aria-label=(format!("Table: robustness on {}", line(&arm.name))) {
            table.map {
                thead { tr {
                    th scope="col" { "law" }
                    @for world in &comparison.worlds { th scope="col" { (line(&world.name)) } }
                } }
                tbody { @for row in comparison.rows_of(&arm.name) { tr {
                    th scope="row" { (named(comparison, row)) }
                    @for world in &comparison.worlds { (place(comparison, row, &world.name)) }
                } } }
            }
        }
    }
}

fn place(comparison: &Comparison, row: &LawRow, world: &str) -> Markup {
    let tuned = row.cell(world, GainsKind::Tuned);
    let designed = is_designed(comparison.rival(&row.rival));
    let default = row.cell(world, GainsKind::Default).filter(|_| !designed);
    let Some(tuned) = tuned else {
        let why = row.refused.as_deref().unwrap_or("not run");
        return html! { td.q-none { span.only title=(line(why)) { "– " span.note { "does not apply" } } } };
    };
    let target = format!("#{}", anchor("row", &format!("{}-{}", row.arm, row.rival)));
    html! { td class=(shade(tuned).class()) { a href=(target) title=(outcome_in_full(&tuned.outcome)) {
        (mark(tuned)) @if unrest(comparison, tuned).is_some() { " ≈" }
        @if let Some(default) = default { span.note { "default " (mark(default)) @if unrest(comparison,
            default).is_some() { " ≈" } } }
        @if designed { span.note { "designed" } }
    } } }
}

/// Error over specification.
fn ratio(cell: &LawCell) -> Option<f64> {
    cell.worst.as_ref().map(|figures| figures.error_over_spec).filter(|ratio| ratio.is_finite())
}

fn shade(cell: &LawCell) -> Shade {
    if !cell.outcome.followed() {
        return if cell.outcome.badness() == 1 { Shade::Beyond } else { Shade::Broken };
    }
    Shade::of(ratio(cell).unwrap_or(f64::INFINITY), LEVELS)
}

/// Symbol and number, or symbol and word.
fn mark(cell: &LawCell) -> String {
    let symbol = symbol_and_word(&cell.outcome).0;
    match ratio(cell) {
        Some(ratio) if cell.outcome.followed() => {
            let kept = if ratio <= 1.0 { "✓ " } else { "" };
            format!("{kept}{}", two_digits(ratio))
        }
        Some(ratio) if cell.outcome.badness() == 1 => format!("{symbol} {}", two_digits(ratio)),
        _ => symbol.to_owned(),
    }
}
