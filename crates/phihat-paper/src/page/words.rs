//! Words, classes and lists that several parts of the page share.

use crate::record::{Origin, Reproduction, Statement, Verdict};

/// Every statement, in the order of the page.
pub(super) fn statements(reproduction: &Reproduction) -> impl Iterator<Item = &Statement> {
    reproduction.sections.iter().flat_map(|section| &section.statements)
}

/// A verdict's class in the style sheet.
pub(super) fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::AsPrinted => "holds",
        Verdict::WithCorrection => "corrected",
        Verdict::Refuted => "refuted",
        Verdict::Open => "open",
    }
}

/// Why a statement is not counted, in a word; empty for the paper's.
pub(super) fn whose(statement: &Statement) -> &'static str {
    match statement.origin {
        Origin::Paper => "",
        Origin::Again => "looked at once more",
        Origin::Ours => "a finding of this project",
    }
}
