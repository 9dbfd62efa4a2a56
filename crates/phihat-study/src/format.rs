//! Description of the format of a study: sections of keys, each with shape, unit, range, default.
//!
//! The tables written in these terms (`keys.rs`, `reference_keys.rs`) are the only place that
//! knows the format; the checks, the manual and the JSON Schema are all made from them.

use std::fmt;

/// A table of the file and the keys it may have.
#[derive(Debug)]
pub(crate) struct FormatSection {
    /// Path as in the file: `world.payload`; empty for the top of the file.
    pub(crate) path: &'static str,
    /// Subject of the section, for the manual.
    pub(crate) doc: &'static str,
    pub(crate) keys: &'static [Key],
}

/// One key.
#[derive(Debug)]
pub(crate) struct Key {
    /// Name, its unit included.
    pub(crate) name: &'static str,
    /// The unit as people write it; empty if there is none.
    pub(crate) unit: &'static str,
    pub(crate) shape: Shape,
    pub(crate) need: Need,
    /// One or two sentences.
    pub(crate) doc: &'static str,
}

/// Shape of a value.
#[derive(Debug)]
pub(crate) enum Shape {
    /// A string of at most 200 characters.
    Text,
    /// One of these words.
    Word(&'static [&'static str]),
    /// `true` or `false`.
    Flag,
    Number(NumberBounds),
    /// A number, or one of these words.
    NumberOrWord(NumberBounds, &'static [&'static str]),
    /// An array of numbers with `min` to `max` entries.
    List {
        min: usize,
        max: usize,
        bounds: NumberBounds,
    },
    /// An array of points `[x, y, z]` with `min` to `max` entries.
    Points {
        min: usize,
        max: usize,
        bounds: NumberBounds,
    },
    /// An array of `count` intervals `[low, high]`.
    Intervals {
        count: usize,
        bounds: NumberBounds,
    },
    /// One number for all joints, an array with one per joint, or a table by joint name; or a word.
    PerJoint(NumberBounds, &'static [&'static str]),
    /// A table by joint name that names any of the joints.
    SomeJoints(NumberBounds),
    Table(&'static FormatSection),
    /// An array of at most so many tables.
    Tables(&'static FormatSection, usize),
    /// A table whose key `kind` says which keys it has.
    Kinds(&'static [SectionKind]),
}

/// One of the kinds of [`Shape::Kinds`].
#[derive(Debug)]
pub(crate) struct SectionKind {
    pub(crate) word: &'static str,
    pub(crate) section: &'static FormatSection,
}

/// Need of a key, and the meaning of its absence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Need {
    Required,
    /// Absence means this, in words.
    Optional(&'static str),
    Number(f64),
    Count(u32),
    Numbers(&'static [f64]),
    Flag(bool),
    Word(&'static str),
}

/// An interval of numbers, closed above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NumberBounds {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// True if `low` itself is outside.
    pub(crate) open: bool,
    /// True if only integers are valid.
    pub(crate) integer: bool,
}

impl NumberBounds {
    /// Above zero, at most `high`.
    pub(crate) const fn positive(high: f64) -> Self {
        Self { low: 0.0, high, open: true, integer: false }
    }

    /// From `low` to `high`.
    pub(crate) const fn closed(low: f64, high: f64) -> Self {
        Self { low, high, open: false, integer: false }
    }

    /// From `-limit` to `limit`.
    pub(crate) const fn within(limit: f64) -> Self {
        Self::closed(-limit, limit)
    }

    /// The integers from `low` to `high`.
    pub(crate) const fn integers(low: f64, high: f64) -> Self {
        Self { low, high, open: false, integer: true }
    }

    /// Returns true if `x` is a number inside; NaN never is.
    pub(crate) fn admit(self, x: f64) -> bool {
        let above = if self.open { x > self.low } else { x >= self.low };
        above && x <= self.high
    }
}

impl fmt::Display for NumberBounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.open {
            write!(f, "above {}, at most {}", self.low, self.high)
        } else {
            write!(f, "{} to {}", self.low, self.high)
        }
    }
}

impl FormatSection {
    /// The key of this name.
    pub(crate) fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }
}
