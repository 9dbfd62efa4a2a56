//! The sortable table of every arm: one row per law, the best of each column marked for whoever has it.

use crate::{ArmRecord, Comparison, GainsKind, LawRow, WorldRecord};
use maud::{Markup, html};

use super::names::{main_world, named};
use super::outcome::{outcome_in_full, symbol_and_word, unrest};
use super::quantity::{PageQuantity, QUANTITIES, QuantitySource};
use super::words;
use phihat_report::kit::anchor;
use phihat_report::kit::number::stated;
use phihat_report::kit::text::line;

/// The table of the main world, and those of the others, folded.
pub(super) fn tables(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let main = main_world(comparison);
    let others = || comparison.worlds.iter().filter(|world| Some(world.name.as_str()) != main);
    let first = comparison.worlds.iter().find(|world| Some(world.name.as_str()) == main);
    html! {
        h3 { "Figures, gains tuned" }
        p.hint {
            "The worst of all motions and joints, after the settling time. ★ marks the best value of a column among \
                laws "
            "whose arm followed, and those within 0.5 % of it. Plain laws come first, then the paper's Table 1 in its \
                order, other "
            "laws, the paper's own, and this project's from positions; with a script, a heading sorts. "
            "Torque noise is what the tuning caps: mean |τ_k − 2τ_{k−1} + τ_{k−2}|/√3 over the joint's torque limit, \
                so that a smooth motion has next to none. "
            "Default gains are in “" a href="#traces" { "Every cell and its trace" } "”."
        }
        @if let Some(world) = first { (table(comparison, arm, world)) }
        @if others().next().is_some() {
            details.worlds {
                summary { "The same in the other worlds" }
                @for world in others() { (table(comparison, arm, world)) }
            }
        }
        h3 { "Tuning and cost" }
        p.hint {
            "Of the law on this arm, not of a world. Share of draws: of gains within a decade of the default ones, \
                those that keep the specification. "
            "Runs to spec: of the tuning. States: numbers kept from sample to sample; instructions: of an update, on \
                this arm."
        }
        (costs(comparison, arm))
    }
}

/// Columns in which some row has a value: without a push there is no recovery.
fn of_a_world(
    comparison: &Comparison,
    arm: &ArmRecord,
    world: &WorldRecord,
) -> Vec<&'static PageQuantity> {
    let known = |quantity: &&PageQuantity| {
        let cell = |row: &LawRow| quantity.of_cell(row, row.cell(&world.name, GainsKind::Tuned));
        matches!(quantity.of, QuantitySource::World(_))
            && comparison.rows_of(&arm.name).any(|row| cell(row).is_some())
    };
    QUANTITIES.iter().filter(known).collect()
}

fn of_a_row() -> impl Iterator<Item = &'static PageQuantity> {
    QUANTITIES.iter().filter(|quantity| matches!(quantity.of, QuantitySource::Row(_)))
}

fn headings(quantities: impl Iterator<Item = &'static PageQuantity>) -> Markup {
    html! { @for quantity in quantities { th scope="col" {
        (quantity.name)
        @if !quantity.unit.is_empty() { " " span.unit { "[" (quantity.unit) "]" } }
    } } }
}

/// Table of the columns of a law as a whole, once for all worlds.
fn costs(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let best: Vec<_> = of_a_row().map(|q| q.best(comparison, &arm.name, "")).collect();
    let label = format!("Table: tuning and cost on {}", line(&arm.name));
    html! {
        div.scroll tabindex="0" role="region" aria-label=(label) { table.sortable.costs {
            thead { tr { th scope="col" { "law" } (headings(of_a_row())) } }
            tbody { @for (place, row) in comparison.rows_of(&arm.name).enumerate() { tr {
                th scope="row" data-v=(place) { (named(comparison, row)) }
                @for (quantity, best) in of_a_row().zip(&best) { (value(quantity, row, "", *best)) }
            } } }
        } }
    }
}

fn table(comparison: &Comparison, arm: &ArmRecord, world: &WorldRecord) -> Markup {
    let columns = of_a_world(comparison, arm, world);
    let best = |q: &'static PageQuantity| (q, q.best(comparison, &arm.name, &world.name));
    let best: Vec<_> = columns.iter().map(|q| best(q)).collect();
    let label = format!("Table: figures on {} in {}", line(&arm.name), line(&world.name));
    html! {
        div.scroll.wide tabindex="0" role="region" aria-label=(label) {
            table.sortable {
                caption { span { "World “" (line(&world.name)) "”: " (words::world(comparison, world)) } }
                thead { tr {
                    th scope="col" { "law" }
                    th scope="col" { "grade" }
                    th scope="col" { "model free" }
                    th scope="col" { "here" }
                    (headings(columns.iter().copied()))
                } }
                tbody { @for (place, row) in comparison.rows_of(&arm.name).enumerate() {
                    (line_of(comparison, row, world, &best, place))
                } }
            }
        }
    }
}

fn line_of(
    comparison: &Comparison,
    row: &LawRow,
    world: &WorldRecord,
    best: &[(&PageQuantity, Option<f64>)],
    place: usize,
) -> Markup {
    let rival = comparison.rival(&row.rival);
    let grade = rival.map_or("", |rival| rival.grade.as_str());
    let model_free = rival.map_or("no", words::model_free);
    html! { tr {
        th scope="row" data-v=(place) { (named(comparison, row)) }
        td data-v=(grade_key(grade)) { (line(grade)) }
        td data-v=(free_key(model_free)) { (model_free) }
        (here(comparison, row, world))
        @for (quantity, best) in best {
            (value(quantity, row, &world.name, *best))
        }
    } }
}

fn grade_key(grade: &str) -> u8 {
    match grade {
        "A" => 0,
        "B" => 1,
        _ => 2,
    }
}

fn free_key(model_free: &str) -> u8 {
    match model_free {
        "yes" => 0,
        "partly" => 1,
        _ => 2,
    }
}

/// Table cell with the outcome of a row's runs in this world.
fn here(comparison: &Comparison, row: &LawRow, world: &WorldRecord) -> Markup {
    if let Some(why) = &row.refused {
        return html! { td.refused data-v="9" { "– does not apply" span.note { (line(why)) } } };
    }
    let Some(cell) = row.cell(&world.name, GainsKind::Tuned) else { return html! { td { "–" } } };
    let (symbol, word) = symbol_and_word(&cell.outcome);
    html! { td.outside[!cell.outcome.followed()] data-v=(cell.outcome.badness()) {
        (symbol) " " (word)
        @if let Some((_, why)) = unrest(comparison, cell) { span.note { (why) } }
        @if !cell.outcome.followed() { span.note {
            (outcome_in_full(&cell.outcome).trim_start_matches(word).trim_start_matches(": ")) } }
        @else if breaks_its_condition(row) { span.note { "outside its own condition" } }
    } }
}

/// Returns true if the tuned gains violate the law's own stability condition: that it ran is luck.
fn breaks_its_condition(row: &LawRow) -> bool {
    let columns = row.columns.as_ref();
    columns.and_then(|columns| columns.condition.as_ref()).is_some_and(|condition| !condition.holds)
}

fn value(quantity: &PageQuantity, row: &LawRow, world: &str, best: Option<f64>) -> Markup {
    let cell = row.cell(world, GainsKind::Tuned);
    let shown = quantity.of_cell(row, cell).filter(|_| row.refused.is_none());
    let Some(shown) = shown else { return html! { td { "–" } } };
    let eligible = quantity.eligible(row, Some(world));
    let is_best = quantity.is_best(eligible, best);
    let broken = quantity.name == "bound / measured" && shown < 1.0;
    let text = three_digits(shown);
    let target = format!("#{}", anchor("row", &format!("{}-{}", row.arm, row.rival)));
    html! { td.best[is_best].outside[broken] data-v=(shown) {
        @if is_best { span.star title="best of the column" { "★\u{a0}" } }
        @if matches!(quantity.of, QuantitySource::World(_)) { a href=(target) { (text) } } @else { (text) }
        @if broken { span.note { "broken" } }
    } }
}

/// The main columns of the same table as text: headings, then one row per law; `*` marks the best of a column.
pub fn comparison_table(comparison: &Comparison, arm: &str, world: &str) -> Vec<Vec<String>> {
    let shown = || QUANTITIES.iter().filter(|quantity| !quantity.short.is_empty());
    let heading = ["law", "grade", "model free", "here"].into_iter();
    let heading = heading.chain(shown().map(|quantity| quantity.short)).map(str::to_owned);
    let mut lines: Vec<Vec<String>> = vec![heading.collect()];
    for row in comparison.rows_of(arm) {
        let rival = comparison.rival(&row.rival);
        let free = rival.map_or("no", words::model_free);
        let cell = row.cell(world, GainsKind::Tuned);
        let here = match cell {
            None => "does not apply",
            Some(cell) => unrest(comparison, cell)
                .map_or(symbol_and_word(&cell.outcome).1, |(short, _)| short),
        };
        let mut texts = vec![
            line(&row.rival),
            rival.map(|rival| line(&rival.grade)).unwrap_or_default(),
            free.to_owned(),
            here.to_owned(),
        ];
        texts.extend(shown().map(|quantity| as_text(comparison, quantity, row, world)));
        lines.push(texts);
    }
    lines
}

fn as_text(comparison: &Comparison, quantity: &PageQuantity, row: &LawRow, world: &str) -> String {
    let shown = quantity.of_cell(row, row.cell(world, GainsKind::Tuned));
    let Some(shown) = shown.filter(|_| row.refused.is_none()) else { return "–".to_owned() };
    let best = quantity.best(comparison, &row.arm, world);
    let mine = quantity.eligible(row, Some(world));
    let is_best = quantity.is_best(mine, best);
    format!("{}{}", three_digits(shown), if is_best { " *" } else { "" })
}

/// Three significant digits: a terminal is narrow.
fn three_digits(value: f64) -> String {
    stated(format!("{value:.2e}").parse().unwrap_or(value))
}
