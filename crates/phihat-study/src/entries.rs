//! The entries of a table: their order, their path, how they are told of.

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::format::{Key, Shape};
use crate::source::Source;

type TableEntry<'t, 'a> = (&'t Spanned<DeString<'a>>, &'t Spanned<DeValue<'a>>);

/// The entries of a table in the order in which the file has them.
pub(crate) fn in_file_order<'t, 'a>(table: &'t DeTable<'a>) -> Vec<TableEntry<'t, 'a>> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

/// Path of `key` inside `path`.
pub(crate) fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// The error for a required key that is not there.
pub(crate) fn missing_key(
    source: &Source<'_>,
    path: &str,
    span: &std::ops::Range<usize>,
    key: &Key,
) -> StudyError {
    let message = match key.shape {
        Shape::Table(_) | Shape::Kinds(_) => format!("missing section [{}]", join(path, key.name)),
        Shape::Tables(..) => format!("missing section [[{}]]", join(path, key.name)),
        _ => "missing key".to_owned(),
    };
    let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
    let first = key.doc.split_once(". ").map_or(key.doc, |(sentence, _)| sentence);
    source
        .error(Kind::MissingKey, span, join(path, key.name), message)
        .with_help(format!("{}{unit}", first.trim_end_matches('.')))
}

/// A string from the file, short enough for a message.
pub(crate) fn clip(text: &str) -> String {
    let mut shown: String = text.chars().take(64).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    shown
}
