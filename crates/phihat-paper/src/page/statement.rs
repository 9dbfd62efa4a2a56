//! Statements: the paper's value beside ours, and everything needed to doubt either.

use crate::item::{Item, Kind};
use crate::record::{Origin, PaperNumber, Section, Statement};
use maud::{Markup, html};

use super::words::{class, whose};
use phihat_report::kit::anchor;
use phihat_report::kit::number::{percent, stated};
use phihat_report::kit::text::{coded, line, prose};

pub(super) fn table(section: &Section) -> Markup {
    let title = line(&section.title);
    html! { @if !section.statements.is_empty() {
        div.scroll.words tabindex="0" role="region" aria-label=(format!("Table: statements of {title}")) {
            table.statements {
                thead { tr {
                    th scope="col" { "place" }
                    th scope="col" { "what is stated" }
                    th scope="col" { "paper" }
                    th scope="col" { "ours" }
                    th scope="col" { "verdict" }
                } }
                tbody { @for statement in &section.statements { (row(statement)) } }
            }
        }
    } }
}

/// Statements of the paper on the figures that a title names ("Figs. 4 and 5: …"), each with what the paper prints and
/// what our figure has; nothing where the title names none.
pub(super) fn printed(section: &Section, title: &str) -> Markup {
    let named = title.split(':').next().unwrap_or_default();
    let named: Vec<u8> = if named.contains("Fig") {
        named.split(|c: char| !c.is_ascii_digit()).filter_map(|part| part.parse().ok()).collect()
    } else {
        Vec::new()
    };
    let about = |statement: &&Statement| {
        let figure = |item: &Item| item.kind == Kind::Figure && named.contains(&item.number);
        statement.origin == Origin::Paper && statement.covers.iter().any(figure)
    };
    let those: Vec<&Statement> = section.statements.iter().filter(about).collect();
    html! { @if !those.is_empty() { aside.printed aria-label="the paper beside our figure" {
        h4 { "The paper, and ours" }
        dl { @for statement in those {
            dt { a href=(format!("#{}", anchor("claim", &statement.id))) { (prose(&statement.claim)) } }
            dd.(class(statement.verdict)) {
                span { "paper: " (prose(&statement.paper)) }
                span { "ours: " (prose(&statement.ours)) }
                span.mark { span.sign { (statement.verdict.sign()) } " " (statement.verdict.words()) }
            }
        } }
    } } }
}

fn row(statement: &Statement) -> Markup {
    let (sign, word) = (statement.verdict.sign(), statement.verdict.words());
    let id = anchor("claim", &statement.id);
    html! {
        tr.statement.(class(statement.verdict)).counted[statement.origin == Origin::Paper] id=(id) {
            th scope="row" {
                a href=(format!("#{id}")) { (prose(&statement.place)) }
                @if statement.origin != Origin::Paper { span.note { (whose(statement)) } }
            }
            td data-label="what is stated" {
                (prose(&statement.claim))
                p.why { (coded(&statement.why)) }
                (evidence(statement))
            }
            td data-label="paper" { (prose(&statement.paper)) }
            td data-label="ours" { (prose(&statement.ours)) }
            td.mark data-label="verdict" { span.sign { (sign) } " " (word) }
        }
    }
}

/// Numbers, studies and assumptions behind a statement.
fn evidence(statement: &Statement) -> Markup {
    let parts = [
        (statement.numbers.len(), "number", "numbers"),
        (statement.studies.len(), "study", "studies"),
        (statement.assumptions.len(), "assumption", "assumptions"),
    ];
    let parts: Vec<_> = parts
        .iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, many)| format!("{count} {}", if *count == 1 { one } else { many }))
        .collect();
    html! { details.evidence {
        summary { @if parts.is_empty() { "name" } @else { (parts.join(", ")) } }
        @if !statement.numbers.is_empty() {
            ul { @for number in &statement.numbers { li { (value(number)) } } }
        }
        @if !statement.studies.is_empty() {
            ul { @for study in &statement.studies { li { code { "phihat run " (line(study)) } } } }
        }
        @if !statement.assumptions.is_empty() {
            p { "Rests on "
                @for (place, id) in statement.assumptions.iter().enumerate() {
                    @if place > 0 { ", " }
                    a href=(format!("#{}", anchor("assumption", id))) { (line(id)) }
                }
                "."
            }
        }
        (scope(statement))
        p.id { "In reproduction.json: " code { (line(&statement.id)) } }
    } }
}

/// Scope of a statement: how it was read, what was varied, where the verdict turns, what it covers.
fn scope(statement: &Statement) -> Markup {
    let Statement { reading, varied, turns, covers, .. } = statement;
    let covers: Vec<String> = covers.iter().map(ToString::to_string).collect();
    html! {
        @if !reading.is_empty() { p.scope { "Read as " (prose(reading)) "." } }
        @if !varied.is_empty() { p.scope { "Varied: " (prose(varied)) "." } }
        @if !turns.is_empty() { p.scope { "Another verdict at " (prose(turns)) "." } }
        @if !covers.is_empty() { p.scope { "Covers " (line(&covers.join(", "))) "." } }
    }
}

fn value(number: &PaperNumber) -> Markup {
    html! {
        (prose(&number.name)) ": "
        @match number.value {
            Some(value) => strong { (stated(value)) },
            None => "none",
        }
        @if !number.unit.is_empty() && number.value.is_some() { " " (line(&number.unit)) }
        @if number.value.is_some() {
            @if number.tolerance > 1.0 { span.unit { " (rounding; agrees up \
                to " (stated(number.tolerance)) " times)" } }
            @else { span.unit { " (agrees within " (percent(number.tolerance, 1.0)) ")" } }
        }
    }
}
