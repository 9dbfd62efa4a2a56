//! A row of Table 1 and the laws here that stand for it.

use phihat_rivals::{Entry, RIVALS, Tick, Ticks};

use crate::compose::words;
use crate::part::PartError;

/// One row: what is printed, and the laws here that stand for it.
pub(super) struct Table1Row {
    pub(super) name: String,
    pub(super) printed: Ticks,
    pub(super) laws: Vec<&'static Entry>,
}

impl Table1Row {
    pub(super) fn of(references: &[&str]) -> Result<Self, PartError> {
        let name = references.join(", ");
        let stands = |entry: &&Entry| {
            entry.card.printed.is_some() && references.contains(&entry.card.reference)
        };
        let laws: Vec<_> = RIVALS.iter().filter(stands).collect();
        let mut printed = laws.iter().filter_map(|entry| entry.card.printed);
        let Some(first) = printed.next() else { return Err(PartError::EmptyRow(name)) };
        if printed.any(|other| other != first) {
            return Err(PartError::MixedRow(name));
        }
        Ok(Self { name, printed: first, laws })
    }

    /// Number of its laws for which the printed mark is right; `None` for "-".
    pub(super) fn right(&self) -> Option<usize> {
        let says = match self.printed.model_free {
            Tick::Yes => true,
            Tick::No => false,
            Tick::Partly => return None,
        };
        Some(self.laws.iter().filter(|entry| entry.needs.model_free() == says).count())
    }

    pub(super) fn cells(&self) -> Vec<String> {
        let Ticks { quantitative, easy, optimal, model_free } = self.printed;
        let marks = [quantitative, easy, optimal, model_free].map(|tick| match tick {
            Tick::Yes => "✓",
            Tick::No => "✗",
            Tick::Partly => "-",
        });
        let here = self.laws.iter().map(|entry| {
            let word = if entry.needs.model_free() { "no model" } else { "a model" };
            format!("{}: {word}", entry.card.id)
        });
        let here: Vec<_> = here.collect();
        [self.name.clone()].into_iter().chain(words(&marks)).chain([here.join("; ")]).collect()
    }
}
