//! The manual of the study file, made from the tables of the format.

use std::fmt::Write;

use phihat_model::Robot;

use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};
use crate::keys::STUDY;
use crate::suggest::sections;

/// The manual of the study file in Markdown: every key with unit, shape, range and default.
///
/// Published as `docs/study.md`.
pub fn manual() -> String {
    let mut out = String::from(include_str!("manual.md"));
    for (kind, section) in sections(&STUDY) {
        out += &heading(kind, section);
        for line in [
            section.doc,
            "",
            "| key | unit | value | if absent | meaning |",
            "|---|---|---|---|---|",
        ] {
            let _ = writeln!(out, "{line}");
        }
        for key in section.keys {
            out += &row(key);
        }
        if section.path == "robot" {
            let names: Vec<String> =
                Robot::names().iter().map(|name| format!("`{name}`")).collect();
            let _ = writeln!(out, "\nBuilt-in robots: {}.", names.join(", "));
        }
    }
    out
}

fn heading(kind: Option<&str>, section: &FormatSection) -> String {
    match (kind, section.path) {
        (_, "") => "\n## The top of the file\n\n".into(),
        (Some(kind), "reference") => format!("\n## `[reference]`, kind = \"{kind}\"\n\n"),
        (Some(_), path) | (None, path @ "world.push") => format!("\n## `[[{path}]]`\n\n"),
        (None, path) => format!("\n## `[{path}]`\n\n"),
    }
}

fn row(key: &Key) -> String {
    let default = match key.need {
        Need::Required => "**required**".into(),
        Need::Optional(words) => words.into(),
        Need::Number(x) => format!("`{x:?}`"),
        Need::Count(n) => format!("`{n}`"),
        Need::Numbers(list) => format!("`{list:?}`"),
        Need::Flag(flag) => format!("`{flag}`"),
        Need::Word(word) => format!("`\"{word}\"`"),
    };
    let (name, unit, value, doc) = (key.name, key.unit, value(&key.shape), key.doc);
    // A bar would end the cell.
    let doc = doc.replace('|', "\\|");
    format!("| `{name}` | {unit} | {value} | {default} | {doc} |\n")
}

fn value(shape: &Shape) -> String {
    match shape {
        Shape::Text => "string".into(),
        Shape::Word(words) => words_of(words),
        Shape::Flag => "`true`, `false`".into(),
        Shape::Number(bounds) => number(*bounds),
        Shape::NumberOrWord(bounds, words) => {
            format!("{}; or {}", number(*bounds), words_of(words))
        }
        Shape::List { min, max, bounds } if min == max => format!("{min} numbers, {bounds}"),
        Shape::List { min, max, bounds } => format!("{min} to {max} numbers, {bounds}"),
        Shape::Points { min, max, bounds } => format!("{min} to {max} points, {bounds}"),
        Shape::Intervals { count, bounds } => format!("{count} intervals `[low, high]`, {bounds}"),
        Shape::PerJoint(bounds, []) => format!("per joint: {}", number(*bounds)),
        Shape::PerJoint(bounds, words) => {
            format!("per joint: {}; or {}", number(*bounds), words_of(words))
        }
        Shape::SomeJoints(bounds) => format!("table by joint name: {}", number(*bounds)),
        Shape::Table(_) | Shape::Kinds(_) => "section".into(),
        Shape::Tables(_, max) => format!("1 to {max} sections"),
    }
}

fn number(bounds: NumberBounds) -> String {
    format!("{} {bounds}", if bounds.integer { "integer," } else { "number," })
}

fn words_of(words: &[&str]) -> String {
    let words: Vec<String> = words.iter().map(|word| format!("`\"{word}\"`")).collect();
    words.join(", ")
}
