//! The page of an own arm.

use maud::html;
use phihat_report::kit::text::{line, prose};
use phihat_report::kit::{Page, anchor};

use super::record::OwnReproduction;
use crate::page::table::values;
use phihat_report::kit::draw::{FigureSize, svg};

/// The self-contained page: nothing is loaded and no script runs.
pub fn own_page(own: &OwnReproduction) -> String {
    let main = html! {
        header {
            h1 { "The paper, on an own arm" }
            p.byline { "study " (line(&own.study)) " · phihat " (line(&own.phihat_version)) " · simulated" }
            p { "φ: " (prose(&own.phi_from)) "; shown: joint " (line(&own.joint)) "." }
        }
        @for section in &own.sections {
            section.part id=(anchor("section", &section.id)) {
                h2 { (prose(&section.title)) }
                @for paragraph in &section.text { p { (prose(paragraph)) } }
                @for table in &section.tables { (values(table)) }
                @for figure in &section.figures {
                    figure.claim id=(anchor("figure", &figure.id)) {
                        div.sheet { (svg(figure, &FigureSize::PAPER)) }
                        figcaption { strong { (prose(&figure.title)) ". " } (prose(&figure.caption)) }
                    }
                }
            }
        }
        h2 id="left-out" { "Not done here" }
        div.scroll.words tabindex="0" role="region" aria-label="Table: what is left out" {
            table {
                thead { tr { th scope="col" { "part of the paper" } th scope="col" { "why, and what does it" } } }
                tbody { @for left in &own.left_out { tr {
                    th scope="row" { (prose(&left.part)) }
                    td { (prose(&left.why)) }
                } } }
            }
        }
        h2 id="limits" { "Not claimed" }
        p { "Everything here is simulated. No verdict on the paper follows: its figures are of another arm, with other \
            gains." }
    };
    Page { title: "The paper, on an own arm", kind: "reproduction", script: None }.document(&main)
}
