//! The page of the reproduction: every statement of the paper with its verdict, and what it rests on.

use crate::record::{Origin, Reproduction, Section, Table, Verdict};
use maud::{Markup, PreEscaped, html};

use crate::figure::draw as reproduction_figure;
use phihat_report::kit::text::{coded, line, prose};
use phihat_report::kit::{Page, anchor};

mod coverage;
mod overview;
mod statement;
mod summary;
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
    Page {
        title: "The paper, reproduced",
        style: include_str!("reproduction.css"),
        script: Some(SCRIPT),
    }
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
                    @let count = section.statements.iter().filter(|s| s.origin == Origin::Paper && s.verdict == verdict).count();
                    @if count > 0 { span.tally title=(verdict.words()) { (verdict.sign()) " " (count) } }
                }
            }
            @for paragraph in &section.text { p { (coded(paragraph)) } }
            (statement::table(section))
            @for figure in &section.figures {
                figure.claim id=(anchor("figure", &figure.id)) {
                    div.sheet { (PreEscaped(reproduction_figure(figure).svg)) }
                    figcaption { strong { (prose(&figure.title)) ". " } (prose(&figure.caption)) }
                }
            }
            @for table in &section.tables { (values(table)) }
        }
    }
}

fn values(table: &Table) -> Markup {
    let title = prose(&table.title);
    let prosaic: Vec<bool> = (0..table.columns.len()).map(|place| is_text(table, place)).collect();
    let class = |place: usize| prosaic.get(place).is_some_and(|text| *text).then_some("text");
    html! {
        div.scroll id=(anchor("table", &table.id)) tabindex="0" role="region" aria-label=(format!("Table: {title}")) {
            table {
                caption { span { (title) } }
                thead { tr { @for (place, column) in table.columns.iter().enumerate() {
                    th scope="col" class=[class(place)] { (prose(column)) }
                } } }
                tbody { @for row in &table.rows { tr {
                    @for (place, cell) in row.iter().enumerate() {
                        @if place == 0 {
                            th scope="row" { (prose(cell)) }
                        } @else {
                            td class=[class(place)] { (prose(cell)) }
                        }
                    }
                } } }
            }
        }
    }
}

/// Returns true if a column contains words: most of its cells begin with no figure.
fn is_text(table: &Table, place: usize) -> bool {
    let cells = table.rows.iter().filter_map(|row| row.get(place)).map(|cell| cell.trim());
    let cells: Vec<&str> = cells.filter(|cell| !cell.is_empty()).collect();
    let figure = |cell: &&&str| {
        let rest = cell.trim_start_matches(['−', '-', '+', '±', '<', '>', '≤', '≥', ' ']);
        let words = cell.split_whitespace().count();
        **cell == "none" || (rest.starts_with(|c: char| c.is_ascii_digit()) && words <= 4)
    };
    2 * cells.iter().filter(figure).count() < cells.len()
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
            "It leaves this page, every figure as SVG, every number in reproduction.json, and the studies. A study runs alone: "
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
            "faults of a real arm. The paper does not publish its arm, its reference and some of its settings: what stands in "
            "their place is listed above as an assumption. “Refuted” says that what is printed is enough to show that a statement "
            "does not hold as it is worded; “open”, that too little is printed to tell. Neither says that the authors did not "
            "measure what they report."
        }
    }
}
