//! First pass: every key is known and every value has its key's shape and range, in file order.

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::entries::{clip, in_file_order, join, missing_key};
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::format::{FormatSection, Need, NumberBounds, Shape};
use crate::keys::STUDY;
use crate::source::Source;
use crate::suggest::{did_you_mean, sections, with_right_unit};
use crate::value::{found, integer, number};

type Value<'a> = Spanned<DeValue<'a>>;

/// Longest string value, in characters.
const TEXT_MAX: usize = 200;

/// Checks a table; `span` is where it begins.
pub(crate) fn check_table(
    source: &Source<'_>,
    section: &'static FormatSection,
    path: &str,
    span: &std::ops::Range<usize>,
    table: &DeTable<'_>,
) -> Result<(), StudyError> {
    let mut helps = Vec::new();
    for (key, value) in in_file_order(table) {
        let checked = if let Some(known) = section.key(key.get_ref()) {
            check_value(source, &known.shape, &join(path, known.name), value)
        } else {
            let error = unknown(source, section, path, key);
            helps.extend(error.help().map(str::to_owned));
            Err(error)
        };
        source.found.keep(checked)?;
    }
    let missing = section
        .keys
        .iter()
        .filter(|key| key.need == Need::Required && !table.contains_key(key.name));
    for key in missing {
        // One mistake, one error: the key is there under another name.
        if helps.iter().any(|help| help.contains(&format!("`{}`", key.name))) {
            source.found.is_misspelt(join(path, key.name));
        } else {
            source.found.note(missing_key(source, path, span, key))?;
        }
    }
    Ok(())
}

fn unknown(
    source: &Source<'_>,
    section: &'static FormatSection,
    path: &str,
    key: &Spanned<DeString<'_>>,
) -> StudyError {
    let name: &str = key.get_ref();
    let shown: String = name.chars().take(64).collect();
    let error =
        |kind, message: String| source.error(kind, &key.span(), join(path, &shown), message);
    if let Some(place) = elsewhere(name, section) {
        return error(Kind::UnknownKey, "not a key of this section".into()).with_help(place);
    }
    if let Some((right, unit)) = with_right_unit(name, section) {
        return error(Kind::WrongUnit, format!("unknown key: the unit here is {unit}"))
            .with_help(format!("write `{right}`"));
    }
    let names: Vec<&str> = section.keys.iter().map(|key| key.name).collect();
    error(Kind::UnknownKey, "unknown key".into()).with_help(did_you_mean(name, &names))
}

/// Another section that has a key of exactly this name.
fn elsewhere(name: &str, section: &'static FormatSection) -> Option<String> {
    let found = sections(&STUDY)
        .into_iter()
        .find(|(_, other)| !std::ptr::eq(*other, section) && other.key(name).is_some());
    found.map(|(word, other)| match (word, other.path) {
        (Some(word), path) if path == section.path => {
            format!("`{name}` belongs to kind = \"{word}\"")
        }
        (_, "") => format!("`{name}` belongs to the top of the file, before the first section"),
        (_, path) => format!("`{name}` belongs in [{path}]"),
    })
}

fn check_value(
    source: &Source<'_>,
    shape: &'static Shape,
    path: &str,
    value: &Value<'_>,
) -> Result<(), StudyError> {
    match (shape, value.get_ref()) {
        (Shape::Text, DeValue::String(text)) => check_text(source, path, value, text),
        (
            Shape::Word(words) | Shape::PerJoint(_, words) | Shape::NumberOrWord(_, words),
            DeValue::String(word),
        ) if !words.is_empty() => check_word(source, words, path, value, word),
        (Shape::Flag, DeValue::Boolean(_)) => Ok(()),
        (Shape::Number(bounds), _)
        | (
            Shape::PerJoint(bounds, _) | Shape::NumberOrWord(bounds, _),
            DeValue::Integer(_) | DeValue::Float(_),
        ) => check_number(source, *bounds, path, value),
        (Shape::PerJoint(bounds, _), DeValue::Array(items)) => {
            let entry = |(i, item)| check_number(source, *bounds, &format!("{path}[{i}]"), item);
            source.found.each(items.iter().enumerate().map(entry)).map(drop)
        }
        (Shape::PerJoint(bounds, _) | Shape::SomeJoints(bounds), DeValue::Table(table)) => {
            let entries = in_file_order(table).into_iter().map(|(name, item)| {
                check_number(source, *bounds, &join(path, name.get_ref()), item)
            });
            source.found.each(entries).map(drop)
        }
        (&Shape::List { min, max, bounds }, DeValue::Array(_)) => {
            let each = |path: &str, item: &Value<'_>| check_number(source, bounds, path, item);
            check_items(source, (min, max, "numbers"), path, value, each)
        }
        (&Shape::Points { min, max, bounds }, DeValue::Array(_)) => {
            let each = |path: &str, item: &Value<'_>| check_point(source, bounds, path, item);
            check_items(source, (min, max, "points"), path, value, each)
        }
        (&Shape::Intervals { count, bounds }, DeValue::Array(_)) => {
            let each = |path: &str, item: &Value<'_>| check_interval(source, bounds, path, item);
            check_items(source, (count, count, "intervals"), path, value, each)
        }
        (Shape::Table(section), DeValue::Table(table)) => {
            check_table(source, section, path, &value.span(), table)
        }
        (&Shape::Tables(section, max), DeValue::Array(_)) => {
            let each = |path: &str, item: &Value<'_>| match item.get_ref() {
                DeValue::Table(table) => check_table(source, section, path, &item.span(), table),
                other => Err(wrong_type(source, "a table", path, item, other)),
            };
            check_items(source, (1, max, "entries"), path, value, each)
        }
        (Shape::Kinds(kinds), DeValue::Table(table)) => {
            let section = kind_section(source, kinds, path, value, table)?;
            check_table(source, section, path, &value.span(), table)
        }
        (shape, other) => Err(wrong_type(source, &expected(shape), path, value, other)),
    }
}

/// The section that a table's `kind` chooses.
pub(crate) fn kind_section(
    source: &Source<'_>,
    kinds: &'static [crate::format::SectionKind],
    path: &str,
    value: &Value<'_>,
    table: &DeTable<'_>,
) -> Result<&'static FormatSection, StudyError> {
    let words: Vec<&str> = kinds.iter().map(|kind| kind.word).collect();
    let key = join(path, "kind");
    let Some(kind) = table.get("kind") else {
        return Err(source
            .error(Kind::MissingKey, &value.span(), key, "missing key")
            .with_help(crate::suggest::one_of(&words)));
    };
    let DeValue::String(word) = kind.get_ref() else {
        return Err(wrong_type(source, "a string", &key, kind, kind.get_ref()));
    };
    let known = kinds.iter().find(|kind| kind.word == word);
    known.map(|kind| kind.section).ok_or_else(|| {
        source
            .error(Kind::UnknownName, &kind.span(), key, format!("unknown kind \"{}\"", clip(word)))
            .with_help(did_you_mean(word, &words))
    })
}

fn check_text(
    source: &Source<'_>,
    path: &str,
    value: &Value<'_>,
    text: &str,
) -> Result<(), StudyError> {
    let error = |message: String| Err(source.error(Kind::OutOfRange, &value.span(), path, message));
    if text.trim().is_empty() {
        error("must not be empty".into())
    } else if text.chars().any(char::is_control) {
        error("must be one line without control characters".into())
    } else if text.chars().count() > TEXT_MAX {
        error(format!("longer than {TEXT_MAX} characters"))
    } else {
        Ok(())
    }
}

fn check_word(
    source: &Source<'_>,
    words: &[&str],
    path: &str,
    value: &Value<'_>,
    word: &str,
) -> Result<(), StudyError> {
    if words.contains(&word) {
        return Ok(());
    }
    let message = format!("\"{}\" is not known here", clip(word));
    Err(source
        .error(Kind::UnknownName, &value.span(), path, message)
        .with_help(did_you_mean(word, words)))
}

fn check_number(
    source: &Source<'_>,
    bounds: NumberBounds,
    path: &str,
    value: &Value<'_>,
) -> Result<(), StudyError> {
    let read =
        |value| if bounds.integer { integer(value).map(|i| i as f64) } else { number(value) };
    let Some(x) = read(value.get_ref()) else {
        let expected = if bounds.integer { "an integer" } else { "a number" };
        return Err(wrong_type(source, expected, path, value, value.get_ref()));
    };
    let error = |message| Err(source.error(Kind::OutOfRange, &value.span(), path, message));
    if !x.is_finite() {
        return error(format!("{x} is not a finite number: {bounds}"));
    }
    if bounds.admit(x) { Ok(()) } else { error(format!("{x} is out of range: {bounds}")) }
}

fn check_point(
    source: &Source<'_>,
    bounds: NumberBounds,
    path: &str,
    value: &Value<'_>,
) -> Result<(), StudyError> {
    let each = |path: &str, item: &Value<'_>| check_number(source, bounds, path, item);
    check_items(source, (3, 3, "numbers"), path, value, each)
}

fn check_interval(
    source: &Source<'_>,
    bounds: NumberBounds,
    path: &str,
    value: &Value<'_>,
) -> Result<(), StudyError> {
    let each = |path: &str, item: &Value<'_>| check_number(source, bounds, path, item);
    check_items(source, (2, 2, "numbers"), path, value, each)?;
    let items = value.get_ref().as_array().into_iter().flat_map(|items| items.iter());
    let ends: Vec<f64> = items.filter_map(|item| number(item.get_ref())).collect();
    match ends[..] {
        [low, high] if low > high => {
            let message = format!("[{low}, {high}] is not an interval: its low end comes first");
            Err(source.error(Kind::OutOfRange, &value.span(), path, message))
        }
        _ => Ok(()),
    }
}

fn check_items(
    source: &Source<'_>,
    (min, max, noun): (usize, usize, &str),
    path: &str,
    value: &Value<'_>,
    each: impl Fn(&str, &Value<'_>) -> Result<(), StudyError>,
) -> Result<(), StudyError> {
    let DeValue::Array(items) = value.get_ref() else {
        return Err(wrong_type(source, "an array", path, value, value.get_ref()));
    };
    if items.len() < min || items.len() > max {
        let wanted = if min == max { format!("{min}") } else { format!("{min} to {max}") };
        let message = format!("{} {noun}, expected {wanted}", items.len());
        return Err(source.error(Kind::WrongLength, &value.span(), path, message));
    }
    let entries = items.iter().enumerate().map(|(i, item)| each(&format!("{path}[{i}]"), item));
    source.found.each(entries).map(drop)
}

fn wrong_type(
    source: &Source<'_>,
    expected: &str,
    path: &str,
    value: &Value<'_>,
    other: &DeValue<'_>,
) -> StudyError {
    let message = format!("expected {expected}, found {}", found(other));
    let error = source.error(Kind::WrongType, &value.span(), path, message);
    // A figure in quotes.
    match other.as_str().filter(|text| text.trim().parse::<f64>().is_ok()) {
        Some(text) => error.with_help(format!("\"{}\" without quotes", clip(text))),
        None => error,
    }
}

fn expected(shape: &Shape) -> String {
    match shape {
        Shape::Text | Shape::Word(_) => "a string".into(),
        Shape::Flag => "true or false".into(),
        Shape::Number(bounds) if bounds.integer => "an integer".into(),
        Shape::Number(_) => "a number".into(),
        Shape::NumberOrWord(_, words) => format!("a number or \"{}\"", words.join("\", \"")),
        Shape::List { .. } => "an array of numbers".into(),
        Shape::Points { .. } => "an array of points [x, y, z]".into(),
        Shape::Intervals { .. } => "an array of intervals [low, high]".into(),
        Shape::PerJoint(_, words) => {
            let forms = "a number, an array with one per joint, a table by joint name";
            if words.is_empty() {
                forms.into()
            } else {
                format!("{forms}, or \"{}\"", words.join("\", or \""))
            }
        }
        Shape::SomeJoints(_) => "a table by joint name".into(),
        Shape::Table(_) | Shape::Kinds(_) => "a table".into(),
        Shape::Tables(..) => "an array of tables".into(),
    }
}
