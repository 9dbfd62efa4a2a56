//! Values of expressions, with Python's conversions to text and to truth.

use std::fmt;

/// Longest text that an expression may make \[bytes\], and most entries of a list or table.
pub(super) const TEXT_MAX: usize = 1 << 18;
pub(super) const ENTRIES_MAX: usize = 10_000;

/// Value of an expression.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum XacroValue {
    None,
    Bool(bool),
    Int(i64),
    Float(f64),
    Text(String),
    List(Vec<XacroValue>),
    /// Keys and values in the order of the file.
    Table(Vec<(XacroValue, XacroValue)>),
}

impl XacroValue {
    /// A number, bool or quoted text that is written as a literal; else the text itself.
    pub(super) fn literal(text: &str) -> Self {
        if let Some(inside) = text.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
            return Self::Text(inside.to_owned());
        }
        let word = text.trim();
        if word.contains('_') {
            return Self::Text(text.to_owned());
        }
        if let Ok(whole) = word.parse() {
            return Self::Int(whole);
        }
        let starts = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+');
        if word.starts_with(starts)
            && let Ok(number) = word.parse()
        {
            return Self::Float(number);
        }
        match word {
            "true" | "True" => Self::Bool(true),
            "false" | "False" => Self::Bool(false),
            _ => Self::Text(text.to_owned()),
        }
    }

    /// The number that it is; a bool is 0 or 1.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Bool(flag) => Some(f64::from(u8::from(*flag))),
            Self::Int(whole) => Some(*whole as f64),
            Self::Float(number) => Some(*number),
            _ => None,
        }
    }

    /// The whole number that it is; a bool is 0 or 1.
    pub(super) fn whole(&self) -> Option<i64> {
        match self {
            Self::Bool(flag) => Some(i64::from(*flag)),
            Self::Int(whole) => Some(*whole),
            _ => None,
        }
    }

    /// Truth in an expression: what is empty or zero is false.
    pub(super) fn truth(&self) -> bool {
        match self {
            Self::None => false,
            Self::Bool(flag) => *flag,
            Self::Int(whole) => *whole != 0,
            Self::Float(number) => number.abs() > 0.0 || number.is_nan(),
            Self::Text(text) => !text.is_empty(),
            Self::List(list) => !list.is_empty(),
            Self::Table(table) => !table.is_empty(),
        }
    }

    /// Truth of a condition: true, false or a number, also where it is written as text.
    pub(super) fn condition(&self) -> Option<bool> {
        match self {
            Self::Text(text) => match Self::literal(text) {
                Self::Text(_) => None,
                read => Some(read.truth()),
            },
            other => Some(other.truth()),
        }
    }

    /// Bytes that a copy of it takes, about.
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::List(list) => list.iter().map(|one| 16 + one.size()).sum(),
            Self::Table(table) => table.iter().map(|(a, b)| 32 + a.size() + b.size()).sum(),
            _ => 0,
        }
    }

    pub(super) fn equals(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::List(a), Self::List(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.equals(b))
            }
            _ => match (self.number(), other.number()) {
                (Some(a), Some(b)) => a.total_cmp(&b).is_eq() || (a - b).abs() <= 0.0,
                _ => self == other,
            },
        }
    }

    /// Name of its type, for errors.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Bool(_) => "a bool",
            Self::Int(_) | Self::Float(_) => "a number",
            Self::Text(_) => "text",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
        }
    }

    /// As it would be written in an expression.
    fn quoted(&self) -> String {
        match self {
            Self::Text(text) => format!("'{text}'"),
            other => other.to_string(),
        }
    }
}

impl fmt::Display for XacroValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("None"),
            Self::Bool(true) => f.write_str("True"),
            Self::Bool(false) => f.write_str("False"),
            Self::Int(whole) => write!(f, "{whole}"),
            Self::Float(number) => f.write_str(&python_float(*number)),
            Self::Text(text) => f.write_str(text),
            Self::List(list) => {
                let all: Vec<String> = list.iter().map(Self::quoted).collect();
                write!(f, "[{}]", all.join(", "))
            }
            Self::Table(table) => {
                let one =
                    |(key, value): &(Self, Self)| format!("{}: {}", key.quoted(), value.quoted());
                let all: Vec<String> = table.iter().map(one).collect();
                write!(f, "{{{}}}", all.join(", "))
            }
        }
    }
}

/// Shortest digits that read back as the same number, with an exponent where Python has one.
fn python_float(number: f64) -> String {
    let size = number.abs();
    if !number.is_finite() {
        let word = if number.is_nan() { "nan" } else { "inf" };
        return if number < 0.0 { format!("-{word}") } else { word.to_owned() };
    }
    if size > 0.0 && !(1e-4..1e16).contains(&size) {
        let text = format!("{number:e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let (sign, exponent) =
            exponent.strip_prefix('-').map_or(('+', exponent), |rest| ('-', rest));
        return format!("{digits}e{sign}{exponent:0>2}");
    }
    format!("{number:?}")
}
