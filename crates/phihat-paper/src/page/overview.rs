//! Overview of the results for the paper: counts, links, assumptions.

use crate::record::{Origin, Reproduction, Statement, Verdict};
use maud::{Markup, html};

use super::words::{class, statements, whose};
use phihat_report::kit::anchor;
use phihat_report::kit::text::{line, prose};

/// The paper.
const PAPER: &str = "R. Hayat, M. Leibold, M. Buss, “Robust-Adaptive Controller Design for Robot Manipulators Using \
                     the H∞ Approach”, IEEE Access, 2018";

/// The paper's statements of a verdict: what is counted.
fn of(reproduction: &Reproduction, verdict: Verdict) -> impl Iterator<Item = &Statement> {
    reproduction.of(Origin::Paper, verdict)
}

pub(super) fn header(reproduction: &Reproduction) -> Markup {
    let count = reproduction.count(Origin::Paper);
    let (again, ours) = (reproduction.count(Origin::Again), reproduction.count(Origin::Ours));
    let correct = of(reproduction, Verdict::AsPrinted).count();
    html! {
        header {
            h1 { "The paper, reproduced" }
            p.byline { (PAPER) }
            p.byline {
                "phihat " (line(&reproduction.phihat_version)) " · " (count) " statements of the paper · computed and \
                    simulated"
                @if reproduction.quick { " · quick: coarser maps and sweeps" }
            }
            @if let Some(only) = &reproduction.only {
                p.partial { strong { "A part of it only:" } " what was chosen by “" (line(only)) "”." }
            }
            div.verdict {
                p { strong { (correct) " of " (count) " statements of the paper hold as printed." } }
                ul.counts { @for verdict in Verdict::ALL {
                    @let (class, sign, count) = (class(verdict), verdict.sign(), of(reproduction, verdict).count());
                    @let word = if count == 1 { verdict.words().to_owned() } else { verdict.words().replace("holds",
                        "hold") };
                    li.(class) { span.sign { (sign) } " " (count) " " (word) }
                } }
                @if again + ours > 0 {
                    p { "Not counted: " (again) " statements looked at once more, and " (ours) " findings of this \
                        project." }
                }
            }
        }
    }
}

/// Choice of the verdicts that are shown; styles do the rest.
pub(super) fn choice() -> Markup {
    html! {
        fieldset.choice {
            legend { "show" }
            label { input type="radio" name="show" id="show-all" checked; " all" }
            @for verdict in Verdict::ALL {
                @let (class, sign, word) = (class(verdict), verdict.sign(), verdict.words());
                label { input type="radio" name="show" id=(format!("show-{class}")); " " (sign) " " (word) }
            }
        }
    }
}

pub(super) fn overview(reproduction: &Reproduction) -> Markup {
    html! {
        div.overview { @for verdict in Verdict::ALL {
            @let (class, sign, word) = (class(verdict), verdict.sign(), verdict.words());
            section.group.(class) {
                h3 { span.sign { (sign) } " " (word) " (" (of(reproduction, verdict).count()) ")" }
                ul { @for statement in of(reproduction, verdict) { li {
                    a href=(format!("#{}", anchor("claim", &statement.id))) { (prose(&statement.place)) }
                    " " (prose(&statement.claim))
                } } }
            }
        } }
        (beside(reproduction))
    }
}

/// Statements that are on the page and not counted.
fn beside(reproduction: &Reproduction) -> Markup {
    let all = || statements(reproduction).filter(|statement| statement.origin != Origin::Paper);
    html! { @if all().next().is_some() {
        h3 { "Not counted" }
        ul.beside { @for statement in all() { li {
            span.sign { (statement.verdict.sign()) } " "
            a href=(format!("#{}", anchor("claim", &statement.id))) { (line(&statement.place)) }
            " " (line(&statement.claim)) " (" (whose(statement)) ")"
        } } }
    } }
}

pub(super) fn assumptions(reproduction: &Reproduction) -> Markup {
    let using = |id: &str| {
        statements(reproduction).filter(|s| s.assumptions.iter().any(|a| a == id)).count()
    };
    html! {
        p { "What the paper does not print, what stands in its place, and how much it matters." }
        div.scroll.words tabindex="0" role="region" aria-label="Table: assumptions" {
            table {
                thead { tr {
                    th scope="col" { "assumption" }
                    th scope="col" { "missing in the paper" }
                    th scope="col" { "assumed" }
                    th scope="col" { "influence" }
                } }
                tbody { @for assumption in &reproduction.assumptions {
                    @let count = using(&assumption.id);
                    tr id=(anchor("assumption", &assumption.id)) {
                        th scope="row" {
                            (line(&assumption.id))
                            span.note { (count) @if count == 1 { " statement" } @else { " statements" } }
                        }
                        td data-label="missing in the paper" { (prose(&assumption.missing)) }
                        td data-label="assumed" { (prose(&assumption.assumed)) }
                        td data-label="influence" {
                            @if assumption.influence.is_empty() { "not \
                                varied" } @else { (prose(&assumption.influence)) }
                        }
                    }
                } }
            }
        }
    }
}
