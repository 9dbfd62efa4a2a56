//! Second pass: a table of the file together with its section; gives values, defaults and errors.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::entries::{clip, join, missing_key};
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::format::{FormatSection, Key, Need, Shape};
use crate::source::Source;
use crate::value::{integer, number};

/// A table of the file; an absent one has no keys.
#[derive(Clone)]
pub(crate) struct Node<'a> {
    pub(crate) source: Source<'a>,
    section: &'static FormatSection,
    path: String,
    span: Range<usize>,
    table: Option<&'a DeTable<'a>>,
}

impl<'a> Node<'a> {
    /// The top of the file.
    pub(crate) fn top(
        source: Source<'a>,
        section: &'static FormatSection,
        table: &'a DeTable<'a>,
    ) -> Self {
        Self { source, section, path: String::new(), span: 0..0, table: Some(table) }
    }

    /// Returns true if the file has this table.
    pub(crate) fn exists(&self) -> bool {
        self.table.is_some()
    }

    /// Returns true if the file has this key.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.value(key).is_some()
    }

    /// The value as the file has it.
    ///
    /// Values that the first pass refused are absent; of tables, only the refused keys are absent.
    pub(crate) fn value(&self, key: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        let value = self.table?.get(key)?;
        let found = self.source.found;
        let holds_keys =
            |key: &Key| matches!(key.shape, Shape::Table(_) | Shape::Tables(..) | Shape::Kinds(_));
        let refused = found.goes_on()
            && !self.section.key(key).is_some_and(holds_keys)
            && found.refuses(&value.span());
        (!refused).then_some(value)
    }

    /// Keeps an error after which the reader can go on.
    ///
    /// # Errors
    ///
    /// The error itself, where the first one is all that is asked for.
    pub(crate) fn note(&self, error: StudyError) -> Result<(), StudyError> {
        self.source.found.note(error)
    }

    /// Returns true if no error was noted in this table so far.
    pub(crate) fn is_clean(&self) -> bool {
        self.source.found.is_clean(&self.path)
    }

    /// The table under `key`, absent or not.
    pub(crate) fn child(&self, key: &str) -> Node<'a> {
        let value = self.value(key);
        let section = self.section.key(key).and_then(|key| match &key.shape {
            Shape::Table(section) => Some(*section),
            Shape::Kinds(kinds) => {
                let word = value?.get_ref().get("kind")?.get_ref().as_str()?;
                kinds.iter().find(|kind| kind.word == word).map(|kind| kind.section)
            }
            _ => None,
        });
        Node {
            source: self.source,
            section: section.unwrap_or(self.section),
            path: join(&self.path, key),
            span: value.map_or(self.span.clone(), Spanned::span),
            table: value.and_then(|value| value.get_ref().as_table()),
        }
    }

    /// The tables under `key`.
    pub(crate) fn children(&self, key: &str) -> Vec<Node<'a>> {
        let Some(Shape::Tables(section, _)) = self.section.key(key).map(|key| &key.shape) else {
            return Vec::new();
        };
        let items = self.value(key).and_then(|value| value.get_ref().as_array());
        let node = |(i, item): (usize, &'a Spanned<DeValue<'a>>)| Node {
            source: self.source,
            section,
            path: format!("{}[{i}]", join(&self.path, key)),
            span: item.span(),
            table: item.get_ref().as_table(),
        };
        items.map(|items| items.iter().enumerate().map(node).collect()).unwrap_or_default()
    }

    /// A string, if it is there.
    pub(crate) fn text(&self, key: &str) -> Option<&'a str> {
        self.value(key)?.get_ref().as_str()
    }

    /// A string, its default, or the error that it is missing.
    pub(crate) fn word(&self, key: &str) -> Result<&'a str, StudyError> {
        match (self.text(key), self.need(key)) {
            (Some(word), _) | (None, Some(Need::Word(word))) => Ok(word),
            _ => Err(self.missing(key)),
        }
    }

    /// A boolean or its default.
    pub(crate) fn flag(&self, key: &str) -> Result<bool, StudyError> {
        match (self.value(key).and_then(|value| value.get_ref().as_bool()), self.need(key)) {
            (Some(flag), _) | (None, Some(Need::Flag(flag))) => Ok(flag),
            _ => Err(self.missing(key)),
        }
    }

    /// A flag, if it is there.
    pub(crate) fn flag_if(&self, key: &str) -> Option<bool> {
        self.value(key).and_then(|value| value.get_ref().as_bool())
    }

    /// A number, if it is there.
    pub(crate) fn number_if(&self, key: &str) -> Option<f64> {
        number(self.value(key)?.get_ref())
    }

    /// A number or its default.
    pub(crate) fn number(&self, key: &str) -> Result<f64, StudyError> {
        match (self.number_if(key), self.need(key)) {
            (Some(x), _) | (None, Some(Need::Number(x))) => Ok(x),
            _ => Err(self.missing(key)),
        }
    }

    /// A count or its default.
    pub(crate) fn count(&self, key: &str) -> Result<u64, StudyError> {
        let count = self.value(key).and_then(|value| integer(value.get_ref()));
        match (count.and_then(|n| u64::try_from(n).ok()), self.need(key)) {
            (Some(n), _) => Ok(n),
            (None, Some(Need::Count(n))) => Ok(n.into()),
            _ => Err(self.missing(key)),
        }
    }

    /// A small count or its default.
    pub(crate) fn small_count(&self, key: &str) -> Result<u32, StudyError> {
        u32::try_from(self.count(key)?).map_err(|_| self.missing(key))
    }

    /// `N` numbers or their default.
    pub(crate) fn numbers<const N: usize>(&self, key: &str) -> Result<[f64; N], StudyError> {
        let list = match (self.list(key), self.need(key)) {
            (Some(list), _) => list,
            (None, Some(Need::Numbers(list))) => list.to_vec(),
            _ => return Err(self.missing(key)),
        };
        list.try_into().map_err(|_| self.missing(key))
    }

    /// An array of numbers, if it is there.
    pub(crate) fn list(&self, key: &str) -> Option<Vec<f64>> {
        let items = self.value(key)?.get_ref().as_array()?;
        items.iter().map(|item| number(item.get_ref())).collect()
    }

    /// An array of points.
    pub(crate) fn points(&self, key: &str) -> Result<Vec<[f64; 3]>, StudyError> {
        let items = self.value(key).and_then(|value| value.get_ref().as_array());
        let coordinate = |item: &DeValue<'_>, i: usize| number(item.get(i)?.get_ref());
        let point = |item: &Spanned<DeValue<'_>>| {
            let item = item.get_ref();
            Some([coordinate(item, 0)?, coordinate(item, 1)?, coordinate(item, 2)?])
        };
        let points = items.and_then(|items| items.iter().map(point).collect());
        points.ok_or_else(|| self.missing(key))
    }

    /// An array of `N` intervals `[low, high]`, if it is there.
    pub(crate) fn intervals<const N: usize>(&self, key: &str) -> Option<[(f64, f64); N]> {
        let items = self.value(key)?.get_ref().as_array()?;
        let end = |item: &DeValue<'_>, i: usize| number(item.get(i)?.get_ref());
        let ends = |item: &Spanned<DeValue<'_>>| {
            let item = item.get_ref();
            Some((end(item, 0)?, end(item, 1)?))
        };
        let intervals: Option<Vec<_>> = items.iter().map(ends).collect();
        intervals?.try_into().ok()
    }

    /// An error at the value of `key`, or at the table's head where the file does not have it.
    pub(crate) fn error(&self, kind: Kind, key: &str, message: impl Into<String>) -> StudyError {
        let span = self.value(key).map_or_else(|| self.span.clone(), Spanned::span);
        self.source.error(kind, &span, join(&self.path, key), message)
    }

    /// An error at entry `i`, which belongs to joint `name`, of the value of `key`.
    pub(crate) fn error_at(
        &self,
        kind: Kind,
        key: &str,
        (i, name): (usize, &str),
        message: impl Into<String>,
    ) -> StudyError {
        let path = join(&self.path, key);
        let entry = self.value(key).and_then(|value| match value.get_ref() {
            DeValue::Array(items) => items.get(i).map(|item| (item.span(), format!("{path}[{i}]"))),
            DeValue::Table(table) => table.get(name).map(|item| (item.span(), join(&path, name))),
            _ => None,
        });
        match entry {
            Some((span, path)) => self.source.error(kind, &span, path, message),
            None => self.error(kind, key, message),
        }
    }

    /// An error at the key `name` of the table under `key`.
    pub(crate) fn error_on_name(
        &self,
        key: &str,
        name: &str,
        message: impl Into<String>,
    ) -> StudyError {
        let table = self.value(key).and_then(|value| value.get_ref().as_table());
        match table.and_then(|table| table.get_key_value(name)) {
            Some((spot, _)) => {
                let path = join(&join(&self.path, key), &clip(name));
                self.source.error(Kind::UnknownName, &spot.span(), path, message)
            }
            None => self.error(Kind::UnknownName, key, message),
        }
    }

    /// The error that a key is missing.
    pub(crate) fn missing(&self, key: &str) -> StudyError {
        match self.section.key(key) {
            Some(known) => missing_key(&self.source, &self.path, &self.span, known),
            None => self.error(Kind::MissingKey, key, "missing key"),
        }
    }

    /// Need of `key`: the meaning of its absence from the file.
    pub(crate) fn need(&self, key: &str) -> Option<Need> {
        self.section.key(key).map(|key: &'static Key| key.need)
    }

    /// Exactly one of two keys: which one.
    pub(crate) fn either<'k>(&self, one: &'k str, other: &'k str) -> Result<&'k str, StudyError> {
        match (self.has(one), self.has(other)) {
            (true, false) => Ok(one),
            (false, true) => Ok(other),
            (false, false) => {
                Err(self.missing(one).with_help(format!("give `{one}` or `{other}`")))
            }
            (true, true) => {
                let key = |key: &str| self.value(key).map_or(0, |value| value.span().start);
                let second = if key(one) > key(other) { one } else { other };
                Err(self
                    .error(Kind::Conflict, second, format!("both `{one}` and `{other}` are given"))
                    .with_help("keep one of them"))
            }
        }
    }
}
