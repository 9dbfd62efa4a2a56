//! The numbered items of the paper, which statements cover.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A kind of numbered item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// `(40)`.
    Equation,
    /// `Fig. 7`.
    Figure,
    /// `Table 2`.
    Table,
    /// `Remark 9`.
    Remark,
    /// `Lemma 1`.
    Lemma,
    /// `Theorem 5`.
    Theorem,
}

impl Kind {
    /// Every kind.
    pub const ALL: [Self; 6] =
        [Self::Equation, Self::Figure, Self::Table, Self::Remark, Self::Lemma, Self::Theorem];

    /// Number of items of this kind in the paper, which numbers them from 1.
    pub fn count(self) -> u8 {
        match self {
            Self::Equation => 51,
            Self::Figure => 14,
            Self::Table => 3,
            Self::Remark => 11,
            Self::Lemma => 1,
            Self::Theorem => 5,
        }
    }

    /// For people: `equations`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Equation => "equations",
            Self::Figure => "figures",
            Self::Table => "tables",
            Self::Remark => "remarks",
            Self::Lemma => "lemmas",
            Self::Theorem => "theorems",
        }
    }
}

/// A numbered item of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Item {
    /// Its kind.
    pub kind: Kind,
    /// Its number.
    pub number: u8,
}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = self.number;
        match self.kind {
            Kind::Equation => write!(f, "({number})"),
            Kind::Figure => write!(f, "Fig. {number}"),
            Kind::Table => write!(f, "Table {number}"),
            Kind::Remark => write!(f, "Remark {number}"),
            Kind::Lemma => write!(f, "Lemma {number}"),
            Kind::Theorem => write!(f, "Theorem {number}"),
        }
    }
}
