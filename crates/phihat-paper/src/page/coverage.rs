//! Table of the numbered items of the paper that are covered.

use maud::{Markup, html};
use phihat_report::kit::text::line;

use crate::coverage::{Coverage, coverage};
use crate::record::Reproduction;

pub(super) fn table(reproduction: &Reproduction) -> Markup {
    html! {
        p { "Counted from the references that every statement gives; what no statement covers is named." }
        div.scroll.words tabindex="0" role="region" aria-label="Table: coverage" {
            table.coverage {
                thead { tr {
                    th scope="col" { "kind" }
                    th scope="col" { "covered" }
                    th scope="col" { "not covered" }
                } }
                tbody { @for part in coverage(reproduction) { (row(&part)) } }
            }
        }
    }
}

fn row(part: &Coverage) -> Markup {
    let left_out: Vec<_> =
        part.left_out.iter().map(|left| format!("{}: {}", left.item, left.why)).collect();
    html! { tr {
        th scope="row" { (part.kind.words()) }
        td data-label="covered" { (part.covered) " of " (part.all) }
        td data-label="not covered" { @if left_out.is_empty() { "none" } @else { (line(&left_out.join("; "))) } }
    } }
}
