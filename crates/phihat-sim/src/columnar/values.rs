//! Values of a column.

use std::collections::HashMap;

/// Type of the values of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValueKind {
    /// Floating-point numbers.
    Numbers,
    /// Whole numbers.
    Integers,
    /// True or false.
    Flags,
    /// Texts.
    Texts,
}

impl ValueKind {
    /// As it is called in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Numbers => "numbers",
            Self::Integers => "whole numbers",
            Self::Flags => "flags",
            Self::Texts => "texts",
        }
    }
}

/// Some rows of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Floating-point numbers; what is null is no number (NaN).
    Numbers(Vec<f64>),
    /// Whole numbers.
    Integers(Vec<i64>),
    /// True or false.
    Flags(Vec<bool>),
    /// Texts; what is null is empty.
    Texts(Texts),
}

/// Texts of which few are different.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Texts {
    words: Vec<String>,
    known: HashMap<String, u32>,
    rows: Vec<u32>,
}

impl Texts {
    /// The text of a row; of one that is not there, none.
    pub fn get(&self, row: usize) -> &str {
        let word = self.rows.get(row).and_then(|at| self.words.get(*at as usize));
        word.map_or("", String::as_str)
    }

    /// The different ones, in the order in which they came.
    pub fn words(&self) -> &[String] {
        &self.words
    }

    /// Of each row, which of [`words`](Self::words) it is.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    pub(super) fn push(&mut self, text: &str) {
        let last = self.rows.last().copied();
        let same =
            last.filter(|last| self.words.get(*last as usize).is_some_and(|word| word == text));
        let word = same.unwrap_or_else(|| self.word(text));
        self.rows.push(word);
    }

    fn word(&mut self, text: &str) -> u32 {
        if let Some(at) = self.known.get(text) {
            return *at;
        }
        let at = u32::try_from(self.words.len()).unwrap_or(u32::MAX);
        self.words.push(text.to_owned());
        self.known.insert(text.to_owned(), at);
        at
    }
}

impl Values {
    pub(super) fn new(kind: ValueKind) -> Self {
        match kind {
            ValueKind::Numbers => Self::Numbers(Vec::new()),
            ValueKind::Integers => Self::Integers(Vec::new()),
            ValueKind::Flags => Self::Flags(Vec::new()),
            ValueKind::Texts => Self::Texts(Texts::default()),
        }
    }

    /// The rows go; words that are known stay.
    pub(super) fn clear(&mut self) {
        match self {
            Self::Numbers(values) => values.clear(),
            Self::Integers(values) => values.clear(),
            Self::Flags(values) => values.clear(),
            Self::Texts(texts) => texts.rows.clear(),
        }
    }

    /// Adds rows of the same column, as [`ParquetTable::read`](crate::ParquetTable::read) hands them over one
    /// after the other.
    pub fn append(&mut self, more: &Self) {
        match (self, more) {
            (Self::Numbers(values), Self::Numbers(more)) => values.extend_from_slice(more),
            (Self::Integers(values), Self::Integers(more)) => values.extend_from_slice(more),
            (Self::Flags(values), Self::Flags(more)) => values.extend_from_slice(more),
            (Self::Texts(texts), Self::Texts(more)) => {
                // Words are never forgotten: those that were known before stand first.
                for word in more.words.get(texts.words.len()..).unwrap_or_default() {
                    texts.word(word);
                }
                texts.rows.extend_from_slice(&more.rows);
            }
            _ => {}
        }
    }
}
