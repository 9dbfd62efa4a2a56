//! The rivals at hand, and what is known of one.

use comfy_table::ColumnConstraint;
use phihat_compare::{
    CompareError, DEFAULTS, Mark, NOT_TUNED, RivalRecord, UNITS, model_free_in_full,
};

use phihat_rivals::{Entry, RIVALS, WITHOUT_ROW, rival as find};

use crate::failure::Failure;
use crate::table::Fitted;

/// Columns of the tables.
const WIDTH: u16 = 120;

/// In place of free scalars.
const DESIGNED: &str = "none: `phihat design STUDY`";

fn record(entry: &Entry) -> RivalRecord {
    RivalRecord::new(entry.card, entry.needs, entry.scalars)
}

/// Prints the list.
pub(super) fn rivals(as_json: bool) -> Result<(), Failure> {
    let records: Vec<_> = RIVALS.iter().map(record).collect();
    if as_json {
        println!("{}", serde_json::to_string_pretty(&records).map_err(Failure::plain)?);
        return Ok(());
    }
    let mut table = table(["id", "title", "grade", "is handed", "free scalars"]);
    for rival in &records {
        let scalars: Vec<_> = rival.scalars.iter().map(|scalar| scalar.name.as_str()).collect();
        let scalars = if scalars.is_empty() { DESIGNED.to_owned() } else { scalars.join(", ") };
        table.add_row([&rival.id, &rival.title, &rival.grade, &rival.needs_words, &scalars]);
    }
    println!("{}", table.wrapped(WIDTH));
    println!("Free scalars: {UNITS}.");
    println!("`phihat compare --rival ID` shows one.");
    println!("Cited by the paper among its control methods, without a row here:");
    let mut works = self::table(["work", "source", "subject", "why no row"]);
    for cited in WITHOUT_ROW {
        works.add_row([cited.reference, cited.source, cited.subject, cited.reason]);
    }
    println!("{}", works.wrapped(WIDTH));
    Ok(())
}

/// Prints one card.
pub(super) fn rival(id: &str, as_json: bool) -> Result<(), Failure> {
    let entry = find(id).ok_or_else(|| CompareError::Rival(id.to_owned()))?;
    let rival = record(entry);
    if as_json {
        println!("{}", serde_json::to_string_pretty(&rival).map_err(Failure::plain)?);
        return Ok(());
    }
    println!("{} · {} {}", rival.id, rival.title, rival.reference);
    for law in rival.law.lines() {
        println!("  {law}");
    }
    println!("source: {}", rival.source);
    println!("grade: {} ({})", rival.grade, grade(&rival.grade));
    if !rival.caveat.is_empty() {
        println!("caveat: {}", rival.caveat);
    }
    println!("is handed: {} ({})", rival.needs_words, model_free_in_full(&rival));
    if let Some(marks) = rival.printed {
        let [quantitative, easy, optimal, model_free] = marks.map(word);
        println!(
            "the paper prints: quantitative performance {quantitative}, easy tuning {easy}, optimal {optimal}, \
             model free {model_free}"
        );
    }
    if rival.scalars.is_empty() {
        println!("gains: {NOT_TUNED}");
        return Ok(());
    }
    println!("gains: {UNITS}");
    println!("default gains: {DEFAULTS}");
    let mut table = table(["scalar", "unit", "default", "range", "meaning"]);
    for s in &rival.scalars {
        let range = format!("{} … {}", s.range[0], s.range[1]);
        table.add_row([&s.name, &s.unit, &s.default.to_string(), &range, &s.meaning]);
    }
    println!("{}", table.wrapped(WIDTH));
    Ok(())
}

fn table<const N: usize>(header: [&str; N]) -> Fitted {
    let mut table = Fitted::new(header);
    // What one types is not broken.
    if let Some(column) = table.column_mut(0) {
        column.set_constraint(ColumnConstraint::ContentWidth);
    }
    table
}

fn grade(grade: &str) -> &'static str {
    match grade {
        "A" => "textbook, or confirmed in a public source or code",
        "B" => "structure confirmed, details reconstructed",
        _ => "the published law was not found: a law of its class stands for it",
    }
}

fn word(mark: Mark) -> &'static str {
    match mark {
        Mark::Yes => "✓",
        Mark::No => "✗",
        Mark::Partly => "–",
    }
}
