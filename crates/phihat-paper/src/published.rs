//! A statement of the paper, and what was found.

use super::item::Item;
use super::record::{Origin, PaperNumber, Statement, Verdict};

/// Statement of the paper, before it is checked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Published<'a> {
    /// Short name, unique.
    pub(crate) id: &'a str,
    /// Place in the paper.
    pub(crate) place: &'a str,
    /// Claim, in our words.
    pub(crate) claim: &'a str,
    /// The paper's value or wording.
    pub(crate) paper: &'a str,
}

impl Published<'_> {
    /// With what was found, and why.
    pub(crate) fn found(
        self,
        ours: impl Into<String>,
        verdict: Verdict,
        why: impl Into<String>,
        numbers: Vec<PaperNumber>,
    ) -> Statement {
        Statement {
            id: self.id.to_owned(),
            place: self.place.to_owned(),
            origin: Origin::Paper,
            claim: self.claim.to_owned(),
            paper: self.paper.to_owned(),
            ours: ours.into(),
            verdict,
            reading: String::new(),
            varied: String::new(),
            turns: String::new(),
            covers: Vec::new(),
            why: why.into(),
            numbers,
            assumptions: Vec::new(),
            studies: Vec::new(),
        }
    }
}

impl Statement {
    /// Sets how it was read.
    #[must_use]
    pub(crate) fn read_as(mut self, reading: impl Into<String>) -> Self {
        self.reading = reading.into();
        self
    }

    /// Sets the assumptions that were varied, and how far.
    #[must_use]
    pub(crate) fn varying(mut self, varied: impl Into<String>) -> Self {
        self.varied = varied.into();
        self
    }

    /// The threshold at which its verdict would be another one.
    #[must_use]
    pub(crate) fn turning(mut self, at: impl Into<String>) -> Self {
        self.turns = at.into();
        self
    }

    /// Sets the numbered items of the paper that it covers.
    #[must_use]
    pub(crate) fn covering(mut self, items: &[Item]) -> Self {
        self.covers = items.to_vec();
        self
    }

    /// The assumptions that it rests on.
    #[must_use]
    pub(crate) fn assuming(mut self, ids: &[&str]) -> Self {
        self.assumptions = super::compose::words(ids);
        self
    }

    /// It is no statement of the paper but a finding of this project about one.
    #[must_use]
    pub(crate) fn ours(self) -> Self {
        Self { origin: Origin::Ours, ..self }
    }

    /// Another statement counts it already.
    #[must_use]
    pub(crate) fn again(self) -> Self {
        Self { origin: Origin::Again, ..self }
    }

    /// The studies behind it.
    #[must_use]
    pub(crate) fn by(mut self, paths: &[&str]) -> Self {
        self.studies = super::compose::words(paths);
        self
    }
}

impl Verdict {
    /// Of a statement that what is printed decides: as printed; if not, with the correction; if not, refuted.
    pub(crate) fn of(as_printed: bool, corrected: bool) -> Self {
        match (as_printed, corrected) {
            (true, _) => Self::AsPrinted,
            (false, true) => Self::WithCorrection,
            (false, false) => Self::Refuted,
        }
    }

    /// Of a statement about something that the paper does not print (its arm, its reference, its settings): where it
    /// does not hold with what was assumed it may have held with what was used, so that it is open.
    pub(crate) fn assumed(as_printed: bool, corrected: bool) -> Self {
        match (as_printed, corrected) {
            (true, _) => Self::AsPrinted,
            (false, true) => Self::WithCorrection,
            (false, false) => Self::Open,
        }
    }
}
