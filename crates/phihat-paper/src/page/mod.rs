//! The page of the reproduction: every statement of the paper with its verdict, and what it rests on.

use crate::record::{Origin, Reproduction, Section, Verdict};
use maud::{Markup, html};

use phihat_report::kit::draw::{FigureSize, svg};
use phihat_report::kit::text::{coded, line, prose};
use phihat_report::kit::{Page, anchor};

mod coverage;
mod overview;
mod statement;
mod summary;
pub(crate) mod table;
mod words;

/// Script of the page: searches, and opens the target of a link.
const SCRIPT: &str = include_str!("reproduction.js");

/// The self-contained page of a reproduction. Nothing is loaded. Its script searches, and opens the target of a
/// link; without it the page reads as well, and the choice of verdicts is made by styles.
pub fn reproduction_page(reproduction: &Reproduction) -> String {
    let main = html! {
        (overview::header(reproduction))
        (summary::summary(reproduction))
        h2 id="statements" { "Every statement" }
        (overview::choice())
        @for section in &reproduction.sections { (part(section)) }
        (folded("overview", "By verdict", &overview::overview(reproduction)))
        (folded("coverage", "What is covered", &coverage::table(reproduction)))
        @if !reproduction.assumptions.is_empty() {
            (folded("assumptions", "Assumptions", &overview::assumptions(reproduction)))
        }
        (again(reproduction))
        (not_claimed())
    };
    Page { title: "The paper, reproduced", kind: "reproduction", script: Some(SCRIPT) }
        .document(&main)
}

/// A part that is opened by a click.
fn folded(id: &str, title: &str, body: &Markup) -> Markup {
    html! { details.part.more id=(id) { summary { h3 { (title) } } (body) } }
}

fn part(section: &Section) -> Markup {
    html! {
        details.part id=(anchor("section", &section.id)) {
            summary {
                h3 { (prose(&section.title)) }
                @for verdict in Verdict::ALL {
                    @let count = section.statements.iter().filter(|s| s.origin == Origin::Paper &&
                        s.verdict == verdict).count();
                    @if count > 0 { span.tally title=(verdict.words()) { (verdict.sign()) " " (count) } }
                }
            }
            @for paragraph in &section.text { p { (coded(paragraph)) } }
            @for figure in &section.figures {
                div.with-paper {
                    figure.claim id=(anchor("figure", &figure.id)) {
                        div.sheet { (svg(figure, &FigureSize::PAPER)) }
                        figcaption { strong { (prose(&figure.title)) ". " } (prose(&figure.caption)) }
                    }
                    (statement::printed(section, &figure.title))
                }
            }
            (statement::table(section))
            @for table in &section.tables { (table::values(table)) }
        }
    }
}

fn again(reproduction: &Reproduction) -> Markup {
    let quick = if reproduction.quick { " --quick" } else { "" };
    html! {
        h2 id="again" { "Make it again" }
        pre tabindex="0" aria-label="command" { code {
            "phihat reproduce" (quick)
            @if let Some(only) = &reproduction.only { " --only \"" (line(only)) "\"" }
        } }
        p {
            "It leaves this page, every figure as SVG, every number in reproduction.json, and the studies. A study \
                runs alone: "
            code { "phihat run studies/paper/NAME.toml" } ". To hold another machine's numbers against these: "
            code { "phihat reproduce --against reproduction.json" } "."
        }
    }
}

fn not_claimed() -> Markup {
    html! {
        h2 id="limits" { "Not claimed" }
        p {
            "Everything here is computed or simulated; no arm was moved, and “experiment” means a simulation with the "
            "faults of a real arm. The paper does not publish its arm, its reference and some of its settings: what \
                stands in "
            "their place is listed above as an assumption. “Refuted” says that what is printed is enough to show that \
                a statement "
            "does not hold as it is worded; “open”, that too little is printed to tell. Neither says that the authors \
                did not "
            "measure what they report."
        }
    }
}
