//! Card of a law, as data for the table.

use serde::Serialize;

/// Certainty of the published form of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Grade {
    /// Textbook, or confirmed in a public source or code.
    A,
    /// Structure confirmed by a public abstract; coefficients or details reconstructed.
    B,
    /// The published law was not found: a well-documented law of the same class stands for it.
    C,
}

/// A tick in the paper's Table 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Tick {
    /// ✓
    Yes,
    /// ✗
    No,
    /// –: "not completely true/known".
    Partly,
}

/// The paper's row of a law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Ticks {
    /// Quantitative performance.
    pub quantitative: Tick,
    /// Easy tuning.
    pub easy: Tick,
    /// Optimal.
    pub optimal: Tick,
    /// Model free.
    pub model_free: Tick,
}

/// A law's name and origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Card {
    /// Short name, `[a-z0-9-]`.
    pub id: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// The paper's reference number, or nothing: `[23]`.
    pub reference: &'static str,
    /// Authors, title, year of the source.
    pub source: &'static str,
    /// Certainty of the form.
    pub grade: Grade,
    /// Parts that were reconstructed or stand for something else; empty for grade A.
    pub caveat: &'static str,
    /// The law in one or few lines, as in the file's documentation.
    pub law: &'static str,
    /// The paper's Table 1; `None` where the law has no row.
    pub printed: Option<Ticks>,
}
