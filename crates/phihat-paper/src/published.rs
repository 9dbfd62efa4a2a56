//! A statement of the paper, and what was found.

use super::record::{Number, Origin, Statement, Verdict};

/// What the paper says, before it is looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Published<'a> {
    /// Short name, unique.
    pub(crate) id: &'a str,
    /// Where it stands.
    pub(crate) place: &'a str,
    /// What is claimed, in our words.
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
        numbers: Vec<Number>,
    ) -> Statement {
        Statement {
            id: self.id.to_owned(),
            place: self.place.to_owned(),
            origin: Origin::Paper,
            claim: self.claim.to_owned(),
            paper: self.paper.to_owned(),
            ours: ours.into(),
            verdict,
            why: why.into(),
            numbers,
            assumptions: Vec::new(),
            studies: Vec::new(),
        }
    }
}

impl Statement {
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
    /// As printed; if not, with the correction; if not, not.
    pub(crate) fn of(as_printed: bool, corrected: bool) -> Self {
        match (as_printed, corrected) {
            (true, _) => Self::Reproduced,
            (false, true) => Self::WithCorrection,
            (false, false) => Self::NotReproducible,
        }
    }
}
